/** How a screw looks: its axis, and its pitch as a helix of true advance. */
import { Curve, TorusGeometry, TubeGeometry, Mesh, Vector3, type Group, type Material } from "three";
import { short } from "../format";
import type { Screw } from "../protocol";
import { across, arrow, along, rod, tip, vector } from "../scene/shapes";

export type Look = { length: number; radius: number; line: number; material: Material };

const MOST_TURNS = 14;
/** Less advance in a turn than this share of the axis looks like none. */
const FLAT = 0.02;

class Helix extends Curve<Vector3> {
  constructor(
    private readonly start: Vector3,
    private readonly axis: Vector3,
    private readonly sides: [Vector3, Vector3],
    private readonly radius: number,
    private readonly turns: number,
    private readonly advance: number,
  ) {
    super();
  }
  override getPoint(t: number, target = new Vector3()): Vector3 {
    const angle = 2 * Math.PI * this.turns * t;
    return target
      .copy(this.start)
      .addScaledVector(this.axis, this.advance * this.turns * t)
      .addScaledVector(this.sides[0], this.radius * Math.cos(angle))
      .addScaledVector(this.sides[1], this.radius * Math.sin(angle));
  }
}

/** The point of the axis nearest to another: where it is drawn. */
export function nearest(screw: Screw, to: Vector3): Vector3 {
  if (!screw.point) return to.clone();
  const [point, direction] = [vector(screw.point), vector(screw.direction).normalize()];
  return point.addScaledVector(direction, to.clone().sub(point).dot(direction));
}

/** Draws a screw through the place on its axis that is nearest to `about`; gives the end of its axis. */
export function drawScrew(group: Group, screw: Screw, about: Vector3, look: Look): Vector3 {
  const direction = vector(screw.direction).normalize();
  const center = nearest(screw, about);
  const half = direction.clone().multiplyScalar(look.length / 2);
  const end = center.clone().add(half);
  if (direction.lengthSq() === 0) return end;
  if (screw.pitch === null) {
    group.add(arrow(center.clone().sub(half), half.clone().multiplyScalar(2), look.line, look.material));
    group.add(tip(end.clone().addScaledVector(direction, -look.line * 9), direction, look.line * 2.8, look.line * 8, look.material));
    return end;
  }
  group.add(rod(center.clone().sub(half), end, look.line * 0.55, look.material));
  group.add(tip(end, direction, look.line * 2, look.line * 7, look.material));
  const advance = 2 * Math.PI * screw.pitch;
  const sides = across(direction);
  if (Math.abs(advance) < FLAT * look.length) {
    turn(group, center, direction, look);
    return end;
  }
  const turns = Math.min((0.8 * look.length) / Math.abs(advance), MOST_TURNS);
  const start = center.clone().addScaledVector(direction, (-advance * turns) / 2);
  const helix = new Helix(start, direction, sides, look.radius, turns, advance);
  const pieces = Math.max(12, Math.ceil(turns * 22));
  group.add(new Mesh(new TubeGeometry(helix, pieces, look.line * 0.7, 6), look.material));
  return end;
}

/** A turn without advance: an arrow around the axis. */
function turn(group: Group, center: Vector3, direction: Vector3, look: Look): void {
  const sweep = 1.75 * Math.PI;
  const ring = new Mesh(new TorusGeometry(look.radius, look.line * 0.7, 6, 40, sweep), look.material);
  const [x, y] = across(direction);
  ring.position.copy(center);
  ring.up.copy(y);
  ring.matrixAutoUpdate = false;
  ring.matrix.makeBasis(x, y, direction).setPosition(center);
  const radial = x.clone().multiplyScalar(Math.cos(sweep)).addScaledVector(y, Math.sin(sweep));
  const tangent = direction.clone().cross(radial);
  const head = tip(
    center.clone().addScaledVector(radial, look.radius).addScaledVector(tangent, look.line * 5),
    tangent, look.line * 2.2, look.line * 6, look.material,
  );
  along(head, tangent);
  group.add(ring, head);
}

export function pitchText(pitch: number | null): string {
  return pitch === null ? "h = ∞" : `h = ${Math.abs(pitch) < 1e-9 ? 0 : short(pitch)}`;
}
