/** Rods, plates and joints for links that bring no shapes of their own. */
import {
  Box3, BoxGeometry, BufferGeometry, Float32BufferAttribute, Group, Matrix4, Mesh, Quaternion, SphereGeometry, Vector3,
  type Object3D,
} from "three";
import type { Pose, Scene, SceneJoint } from "../protocol";
import { glass, solid } from "../scene/palette";
import { along, block, capsule, drum, vector } from "../scene/shapes";
import { points, type Sizes } from "./plan";

const TURNING = new Set(["revolute", "continuous", "helical"]);
const SLIDING = new Set(["prismatic", "cylindrical"]);

export function setPose(object: Object3D, pose: Pose): void {
  object.position.set(...pose.position);
  const [w, x, y, z] = pose.quaternion;
  object.quaternion.set(x, y, z, w);
}

/** The rods of a link: a rod or a star, a plate where it holds three places or more. */
export function linkBody(scene: Scene, index: number, size: Sizes): Group {
  const group = new Group();
  const link = scene.links[index];
  if (!link) return group;
  const corners = points(scene, link, false);
  // The controlled frame is not a corner of a plate.
  const places = corners.length >= 3 ? corners : points(scene, link);
  const isGround = !scene.joints.some((joint) => joint.child === index);
  const body = solid(index % 2 === 0 ? "body" : "body-2");
  const slide = slideOf(scene, index);
  if (isGround) {
    const [only] = places;
    const column = places.length === 1 && scene.dimension === 3 && only && only.length() > size.joint;
    if (column) group.add(capsule(new Vector3(), only, size.rod * 1.15, solid("body-2")));
    for (const place of column ? [new Vector3()] : places) group.add(foot(place, size, scene.dimension === 2));
    if (places.length >= 3 && scene.dimension === 3) group.add(plate(places, size, true));
  } else if (isLoose(scene, index)) {
    group.add(thing(places, size));
  } else if (places.length >= 3 && inRing(places)) {
    group.add(plate(places, size, false));
  } else {
    const [first, ...others] = places;
    for (const other of others) {
      if (!first) break;
      const sleeve = slide && slide.at.distanceTo(other) < 1e-6 * scene.reach;
      const end = sleeve ? first.clone().lerp(other, 0.56) : other;
      group.add(capsule(first, end, sleeve ? size.rod * 1.35 : size.rod, body));
    }
  }
  group.traverse((part) => {
    part.castShadow = true;
    part.receiveShadow = !isGround;
  });
  return group;
}

/** Whether a link is carried by nothing: an object that is held. */
function isLoose(scene: Scene, link: number): boolean {
  return scene.joints.some(({ child, kind }) => child === link && (kind === "free" || kind === "planar"));
}

/** A held object: a block with its contacts on it. */
function thing(places: Vector3[], size: Sizes): Mesh {
  const box = new Box3().setFromPoints(places);
  const edges = box.getSize(new Vector3());
  const least = Math.max(2.2 * size.joint, 0.45 * Math.max(edges.x, edges.y, edges.z));
  const shape = new BoxGeometry(Math.max(edges.x, least), Math.max(edges.y, least), Math.max(edges.z, least));
  const mesh = new Mesh(shape, glass("object", 0.8));
  box.getCenter(mesh.position);
  return mesh;
}

/** Where another link slides along this one's rod. */
function slideOf(scene: Scene, link: number): { at: Vector3 } | null {
  const own = scene.links[link]?.anchors.find((anchor) => anchor.kind === "joint");
  for (const joint of scene.joints) {
    if (joint.parent !== link || !SLIDING.has(joint.kind) || !own) continue;
    const at = vector(joint.origin.position);
    const way = at.clone().sub(vector(own.position));
    if (way.length() > 1e-6 * scene.reach && way.angleTo(axisInParent(joint)) < 0.02) return { at };
  }
  return null;
}

export function axisInParent(joint: SceneJoint): Vector3 {
  const [w, x, y, z] = joint.origin.quaternion;
  return vector(joint.axis).applyQuaternion(new Quaternion(x, y, z, w)).normalize();
}

/** The mark of a joint, to be put into its parent link. */
export function jointMark(scene: Scene, joint: SceneJoint, size: Sizes): Object3D | null {
  if (joint.kind === "fixed" || joint.kind === "free" || joint.kind === "planar") return null;
  const at = vector(joint.origin.position);
  const axis = axisInParent(joint);
  const group = mark(joint.kind, at, axis, joint.actuated, size, scene.dimension === 2);
  if (!group) return null;
  if (SLIDING.has(joint.kind) && slideOf(scene, joint.parent)) {
    const own = scene.links[joint.parent]?.anchors.find((anchor) => anchor.kind === "joint");
    if (own) group.position.copy(vector(own.position).lerp(at, 0.56));
  }
  return group;
}

/** The mark of a joint's kind: a drum turns, a block slides, a ball turns every way. */
export function mark(kind: string, at: Vector3, axis: Vector3, actuated: boolean, size: Sizes, flat: boolean): Group | null {
  const group = new Group();
  const colour = solid(actuated ? "joint-actuated" : "joint-passive");
  const r = size.joint;
  const none = new Vector3();
  if (TURNING.has(kind)) {
    group.add(drum(none, axis, r, flat ? r * 1.5 : r * 2.5, colour));
    group.add(drum(none, axis, r * 0.5, flat ? r * 1.62 : r * 2.62, solid(actuated ? "body" : "joint-actuated")));
  } else if (SLIDING.has(kind)) {
    group.add(block(none, axis, r * 1.9, r * 2.5, colour));
  } else if (kind === "universal") {
    group.add(new Mesh(new SphereGeometry(r * 0.95, 24, 16), colour));
    group.add(drum(none, axis, r * 0.5, r * 2.7, colour));
  } else if (kind === "spherical") {
    group.add(new Mesh(new SphereGeometry(r * 1.05, 28, 18), colour));
  } else {
    return null;
  }
  group.position.copy(at);
  group.traverse((part) => {
    part.castShadow = true;
  });
  return group;
}

/** What carries a joint on the ground. */
function foot(at: Vector3, size: Sizes, flat: boolean): Group {
  const group = new Group();
  const up = new Vector3(0, 0, 1);
  if (flat) {
    group.add(drum(at.clone().addScaledVector(up, -size.joint * 1.2), up, size.joint * 1.7, size.joint * 0.9, solid("body-2")));
  } else {
    group.add(drum(at.clone().addScaledVector(up, -size.joint * 0.5), up, size.joint * 1.7, size.joint, solid("body-2")));
  }
  return group;
}

/** Whether places lie around their middle, so that a plate through them is no zigzag. */
function inRing(places: Vector3[]): boolean {
  const [a, b, c] = places;
  if (!a || !b || !c) return false;
  return new Vector3().subVectors(b, a).cross(new Vector3().subVectors(c, a)).length() > 1e-3 * a.distanceTo(b) * a.distanceTo(c);
}

/** A ring of rods around places, filled. */
function plate(places: Vector3[], size: Sizes, thin: boolean): Group {
  const group = new Group();
  const middle = places.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(places.length);
  const normal = new Vector3();
  places.forEach((p, i) => normal.add(p.clone().sub(middle).cross((places[(i + 1) % places.length] ?? p).clone().sub(middle))));
  if (normal.lengthSq() === 0) normal.set(0, 0, 1);
  const turn = new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(normal.normalize(), new Vector3(0, 0, 1)));
  const angle = (p: Vector3): number => {
    const q = p.clone().sub(middle).applyMatrix4(turn);
    return Math.atan2(q.y, q.x);
  };
  const ring = [...places].sort((p, q) => angle(p) - angle(q));
  const corners: number[] = [];
  ring.forEach((p, i) => {
    const next = ring[(i + 1) % ring.length] ?? p;
    group.add(capsule(p, next, size.rod * (thin ? 0.45 : 0.9), solid(thin ? "body-2" : "body")));
    corners.push(...middle.toArray(), ...p.toArray(), ...next.toArray());
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(corners, 3));
  geometry.computeVertexNormals();
  if (!thin) group.add(new Mesh(geometry, glass("body", 0.55)));
  return group;
}

/** A thin rod between two points that move, for what slides. */
export class Slide {
  readonly object: Mesh;
  constructor(radius: number) {
    this.object = drum(new Vector3(), new Vector3(0, 1, 0), radius, 1, solid("body"));
    this.object.castShadow = true;
  }

  between(from: Vector3, to: Vector3): void {
    const way = to.clone().sub(from);
    const length = way.length();
    this.object.visible = length > 0;
    this.object.position.copy(from).addScaledVector(way, 0.5);
    this.object.scale.set(1, Math.max(length, 1e-9), 1);
    along(this.object, way);
  }
}
