/** How large the drawn rods and joints of a robot are, from its reach and its links. */
import type { Scene, SceneLink } from "../protocol";
import { vector } from "../scene/shapes";

export type Sizes = { rod: number; joint: number };

/** Points closer than this share of the reach are one. */
const SAME = 1e-6;

export function sizes(scene: Scene): Sizes {
  const lengths: number[] = [];
  for (const link of scene.links) {
    const [first, ...others] = points(link, scene.reach);
    for (const other of others) if (first) lengths.push(first.distanceTo(other));
  }
  lengths.sort((a, b) => a - b);
  const middle = lengths[Math.floor(lengths.length / 2)] ?? scene.reach;
  const rod = Math.min(0.02 * scene.reach, 0.13 * middle);
  return { rod: Math.max(rod, 0.006 * scene.reach), joint: Math.max(1.55 * rod, 0.01 * scene.reach) };
}

/** The places of a link that joints, contacts and the tool take, no place twice, its own joint first. */
export function points(link: SceneLink, reach: number): ReturnType<typeof vector>[] {
  const found: ReturnType<typeof vector>[] = [];
  const anchors = [...link.anchors].sort((a, b) => Number(b.kind === "joint") - Number(a.kind === "joint"));
  for (const anchor of anchors) {
    const point = vector(anchor.position);
    if (!found.some((other) => other.distanceTo(point) < SAME * reach)) found.push(point);
  }
  return found;
}
