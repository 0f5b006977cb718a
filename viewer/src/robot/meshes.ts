/** Shapes of the model's files: simple bodies, and meshes that the server hands out. */
import {
  BoxGeometry, CapsuleGeometry, Color, CylinderGeometry, FileLoader, Group, Mesh, MeshStandardMaterial,
  PlaneGeometry, Quaternion, SphereGeometry, type BufferGeometry, type Material, type Object3D,
} from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { MTLLoader } from "three/addons/loaders/MTLLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import type { Colour, MeshShape, SimpleShape, Visual } from "../protocol";
import { solid } from "../scene/palette";
import { setPose } from "./skeleton";

/** STL has facets alone: edges flatter than this (rad) are rounded, in meshes of fewer corners than that. */
const CREASE = 0.6;
const SMOOTHED = 300_000;

/** The side of the square that stands for a plane (m). */
const PLANE = 4;

export type MeshVisual = MeshShape & { rgba: Colour };
const loaded = new Map<string, Promise<Object3D>>();

function material(rgba: Colour): MeshStandardMaterial {
  if (!rgba) return solid("mesh");
  const [r, g, b, a] = rgba;
  const made = new MeshStandardMaterial({ roughness: 0.62, metalness: 0.06, transparent: a < 1, opacity: a });
  made.color = new Color().setRGB(r, g, b, "srgb");
  return made;
}

/** Along z, as the server's cylinders and capsules lie. */
function upright(geometry: BufferGeometry): BufferGeometry {
  return geometry.rotateX(Math.PI / 2);
}

/** The body of a visual, in its link. Rejects with a sentence where its mesh is not to be had. */
export async function visualBody(visual: Visual): Promise<Object3D> {
  const holder = new Group();
  setPose(holder, visual.pose);
  if (visual.kind === "mesh") {
    const body = await mesh(visual);
    body.scale.multiply({ x: visual.scale[0], y: visual.scale[1], z: visual.scale[2] });
    holder.add(body);
  } else {
    holder.add(new Mesh(simple(visual), material(visual.rgba)));
  }
  holder.traverse((part) => {
    part.castShadow = true;
    part.receiveShadow = true;
  });
  return holder;
}

/** A body of one material. Rejects with a sentence where its mesh is not to be had. */
export async function paintedBody(shape: SimpleShape | MeshShape, paint: Material): Promise<Object3D> {
  if (shape.kind !== "mesh") return new Mesh(simple(shape), paint);
  const body = await mesh({ ...shape, rgba: null });
  body.scale.multiply({ x: shape.scale[0], y: shape.scale[1], z: shape.scale[2] });
  body.traverse((part) => {
    if (part instanceof Mesh) part.material = paint;
  });
  const holder = new Group();
  holder.add(body);
  return holder;
}

function simple(visual: SimpleShape): BufferGeometry {
  switch (visual.kind) {
    case "box":
      return new BoxGeometry(...visual.size);
    case "cylinder":
      return upright(new CylinderGeometry(visual.radius, visual.radius, visual.length, 40));
    case "capsule":
      return upright(new CapsuleGeometry(visual.radius, visual.length, 10, 32));
    case "sphere":
      return new SphereGeometry(visual.radius, 36, 24);
    case "ellipsoid":
      return new SphereGeometry(1, 36, 24).scale(...visual.radii);
    case "half_space":
      return new PlaneGeometry(PLANE, PLANE);
  }
}

/** What is drawn alike is one body. */
export function bodyKey({ url, format, rgba }: MeshVisual): string {
  return `${url} ${format === "dae" ? "" : JSON.stringify(rgba)}`;
}

/** A body that is there already, in place of what would be fetched. */
export function provide(visual: MeshVisual, body: Object3D): void {
  if (visual.format === "stl") {
    const paint = material(visual.rgba);
    body.traverse((part) => {
      if (part instanceof Mesh) part.material = paint;
    });
  }
  loaded.set(bodyKey(visual), Promise.resolve(body));
}

/** The body of a mesh file, in its own unit. Rejects with a sentence where it is not to be had. */
export async function mesh(visual: MeshVisual): Promise<Object3D> {
  const { url } = visual;
  if (url === null) throw new Error(visual.problem ?? `${visual.uri} was not found`);
  const key = bodyKey(visual);
  let waiting = loaded.get(key);
  if (!waiting) {
    waiting = read(url, visual).then(finite);
    loaded.set(key, waiting);
    // Of a mesh that has changed, versions before it are not wanted again.
    const [path] = url.split("?");
    for (const known of loaded.keys()) if (path !== url && known.split(/[? ]/)[0] === path && !known.startsWith(`${url} `)) loaded.delete(known);
    waiting.catch(() => loaded.delete(key));
  }
  try {
    return (await waiting).clone();
  } catch (error) {
    throw new Error(`${visual.uri}: ${error instanceof Error ? error.message : "cannot be read"}`);
  }
}

/** Rejects a body with vertices that no view could contain, or without any. */
function finite(body: Object3D): Object3D {
  let count = 0;
  body.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    const { array } = (part.geometry as BufferGeometry).getAttribute("position");
    count += array.length;
    for (const x of array) if (!Number.isFinite(x)) throw new Error("it has vertices that are not finite");
  });
  if (count === 0) throw new Error("it has no vertices");
  return body;
}

async function read(url: string, visual: MeshVisual): Promise<Object3D> {
  if (visual.format === "stl") {
    const geometry = await new STLLoader().loadAsync(url);
    const isSmall = (geometry.getAttribute("position")?.count ?? 0) < SMOOTHED;
    return new Mesh(isSmall ? toCreasedNormals(geometry, CREASE) : geometry, material(visual.rgba));
  }
  if (visual.format === "dae") return collada(url);
  return wavefront(url, visual.rgba);
}

/** As ROS tools read it: the axes of the file as they are, its unit as it says. */
async function collada(url: string): Promise<Object3D> {
  const text = String(await new FileLoader().loadAsync(url));
  const upAsIs = text.replace(/<up_axis>[^<]*<\/up_axis>/, ""); // else the loader turns the scene
  const parsed = new ColladaLoader().parse(upAsIs, url.slice(0, url.lastIndexOf("/") + 1));
  if (!parsed) throw new Error("is not a Collada file");
  const scene = parsed.scene;
  scene.quaternion.copy(new Quaternion());
  const lamps: Object3D[] = [];
  scene.traverse((part) => {
    if ("isLight" in part || "isCamera" in part) lamps.push(part);
  });
  for (const lamp of lamps) lamp.removeFromParent();
  return scene;
}

async function wavefront(url: string, rgba: Colour): Promise<Object3D> {
  const text = String(await new FileLoader().loadAsync(url));
  const folder = url.slice(0, url.lastIndexOf("/") + 1);
  const library = /^mtllib\s+(.+?)\s*$/m.exec(text)?.[1];
  const loader = new OBJLoader();
  if (library && !rgba) {
    try {
      const materials = await new MTLLoader().setResourcePath(folder).loadAsync(folder + library);
      materials.preload();
      return loader.setMaterials(materials).parse(text);
    } catch {
      // its shape can be shown without its paint
    }
  }
  const body = loader.parse(text);
  body.traverse((part) => {
    if (part instanceof Mesh) part.material = material(rgba);
  });
  return body;
}
