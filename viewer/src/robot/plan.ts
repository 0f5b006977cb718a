/** How large the drawn rods and joints of a robot are, from its reach and its links. */
import type { Scene, SceneLink } from "../protocol";
import { vector } from "../scene/shapes";

export type Sizes = { rod: number; joint: number };

/** Points closer than this share of the reach are one. */
const SAME = 1e-6;

export function sizes(scene: Scene): Sizes {
  const lengths: number[] = [];
  for (const link of scene.links) {
    const [first, ...others] = points(scene, link);
    for (const other of others) if (first) lengths.push(first.distanceTo(other));
  }
  lengths.sort((a, b) => a - b);
  const long = lengths[Math.floor(lengths.length * 0.75)] ?? scene.reach;
  const rod = Math.min(0.02 * scene.reach, 0.09 * long);
  return { rod: Math.max(rod, 0.006 * scene.reach), joint: Math.max(1.45 * rod, 0.01 * scene.reach) };
}

/** The places of a link that joints, contacts and the tool take, no place twice, its own joint first; a free body hangs on nothing. */
export function points(scene: Scene, link: SceneLink, withFrame = true): ReturnType<typeof vector>[] {
  const found: ReturnType<typeof vector>[] = [];
  const loose = new Set(scene.joints.filter(({ kind }) => kind === "free" || kind === "planar").map(({ name }) => name));
  const kept = link.anchors.filter((anchor) => (anchor.kind === "frame" ? withFrame : !loose.has(anchor.name)));
  const anchors = kept.sort((a, b) => Number(b.kind === "joint") - Number(a.kind === "joint"));
  for (const anchor of anchors) {
    const point = vector(anchor.position);
    if (!found.some((other) => other.distanceTo(point) < SAME * scene.reach)) found.push(point);
  }
  return found;
}
