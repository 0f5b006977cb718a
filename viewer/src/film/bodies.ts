/** The bodies that a recording brings with it. */
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { Obstacle, Scene } from "../protocol";
import { provide, type MeshVisual } from "../robot/meshes";

/** Puts the bodies where the page looks for those of its server. */
export async function offer(scenes: Scene[], bodies: ArrayBuffer): Promise<void> {
  const { scene: all } = await new GLTFLoader().parseAsync(bodies, "");
  for (const visual of scenes.flatMap(meshesOf)) {
    const body = all.getObjectByName(nameOf(Number(visual.url)));
    if (visual.url !== null && body) provide(visual, body);
  }
}

export function nameOf(number: number): string {
  return `body-${number}`;
}

/** Those of a scene, which may be changed. */
export function meshesOf(scene: Scene): MeshVisual[] {
  const isMesh = <T extends { kind: string }>(shape: T): shape is T & { kind: "mesh" } => shape.kind === "mesh";
  const visuals = scene.links.flatMap((link) => link.visuals.filter(isMesh));
  const obstacles = scene.obstacles.filter(isMesh).map((obstacle: Obstacle & { kind: "mesh" }) => Object.assign(obstacle, { rgba: null }));
  return [...visuals, ...obstacles];
}
