/** The meshes of scenes in one binary glTF, so that no server is needed to show them. */
import { Group, Mesh, type BufferGeometry, type Object3D } from "three";
import { mergeVertices } from "three/addons/utils/BufferGeometryUtils.js";
import type { Scene } from "../protocol";
import { bodyKey, mesh, type MeshVisual } from "../robot/meshes";
import { meshesOf, nameOf } from "./bodies";

/** Vertices closer than this share of a body are one, if their normals are (one part in 100 000 is not seen). */
const SAME = 1e-5;

/** Scenes whose meshes have numbers in place of addresses, and the bodies of these numbers; `sessions` of models beside have numbers, too. */
export async function collected(scenes: Scene[], sessions: Map<string, string>): Promise<{ scenes: Scene[]; bodies: Blob }> {
  const { GLTFExporter } = await import("three/addons/exporters/GLTFExporter.js");
  const numbers = new Map<string, number>();
  const all = new Group();
  const numbered = async (visual: MeshVisual): Promise<void> => {
    const key = bodyKey(visual);
    let number = numbers.get(key);
    if (number === undefined) {
      try {
        all.add(holder(numbers.size, await mesh(visual)));
      } catch (error) {
        // It is told as the page tells it.
        [visual.url, visual.problem] = [null, error instanceof Error ? error.message : String(error)];
        return;
      }
      number = numbers.size;
      numbers.set(key, number);
    }
    visual.url = String(number);
  };
  const copies = scenes.map((scene) => bare(scene, sessions));
  for (const visual of copies.flatMap(meshesOf)) if (visual.url !== null) await numbered(visual);
  const file = await new GLTFExporter().parseAsync(all, { binary: true });
  return { scenes: copies, bodies: new Blob([file as ArrayBuffer]) };
}

function holder(number: number, body: Object3D): Group {
  const made = new Group();
  made.name = nameOf(number);
  const copy = body.clone();
  copy.traverse((part) => {
    if (part instanceof Mesh) part.geometry = indexed(part.geometry as BufferGeometry);
  });
  return made.add(copy);
}

function indexed(geometry: BufferGeometry): BufferGeometry {
  if (geometry.index) return geometry;
  geometry.computeBoundingSphere();
  return mergeVertices(geometry, SAME * (geometry.boundingSphere?.radius ?? 1));
}

/** A copy without what is not shown: shapes of collisions, and models beside the first of which there are no states. */
function bare(scene: Scene, sessions: Map<string, string>): Scene {
  const beside = scene.beside.flatMap((one) => {
    const session = sessions.get(one.session);
    return session === undefined ? [] : [{ ...one, model: null, session }];
  });
  return structuredClone({ ...scene, beside, links: scene.links.map((link) => ({ ...link, collisions: [] })) });
}
