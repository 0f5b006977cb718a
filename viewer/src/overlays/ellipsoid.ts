/** Ellipsoids of velocity and force: semi-axes as the server drew them, rims, and what is infinite. */
import { BufferGeometry, Float32BufferAttribute, LineLoop, Mesh, SphereGeometry, Vector3, type Group } from "three";
import { short } from "../format";
import type { Ellipsoid } from "../protocol";
import { drawn, glass, hair } from "../scene/palette";
import { across, arrow, basis, rod, vector } from "../scene/shapes";
import type { Context } from "./overlay";

/** Of a drawn semi-axis, over the size of the robot. */
const LONGEST = 0.32;

const BALL = new SphereGeometry(1, 36, 24);
BALL.userData["shared"] = true;
const RIM = new BufferGeometry();
RIM.userData["shared"] = true;
RIM.setAttribute(
  "position",
  new Float32BufferAttribute(
    Array.from({ length: 72 }, (_, i) => [Math.cos((i * Math.PI) / 36), Math.sin((i * Math.PI) / 36), 0]).flat(),
    3,
  ),
);

export function ellipsoid(colour: string) {
  return {
    colour,
    draw(group: Group, data: Ellipsoid, context: Context): void {
      const center = vector(data.center);
      const factor = fitting(data, context.size);
      const [x, y, z] = threeAxes(data, factor, context.line * 0.25);
      const body = new Mesh(BALL, glass(colour, 0.16));
      place(body, basis(x, y, z, center));
      group.add(body);
      for (const [a, b] of [[x, y], [y, z], [z, x]] as const) {
        const normal = a.clone().cross(b).normalize();
        const rim = new LineLoop(RIM, hair(colour, 0.85));
        place(rim, basis(a, b, normal, center));
        group.add(rim);
      }
      for (const axis of data.axes) {
        const way = vector(axis.vector).multiplyScalar(factor);
        group.add(rod(center.clone().sub(way), center.clone().add(way), context.line * 0.32, drawn(colour, 0.9)));
      }
      for (const direction of data.infinite) {
        const way = vector(direction).multiplyScalar(0.55 * context.size);
        for (const side of [1, -1]) group.add(arrow(center, way.clone().multiplyScalar(side), context.line * 0.6, drawn(colour)));
      }
    },
    words(data: Ellipsoid, context: Context): string {
      const sizes = data.axes.map((axis) => short(axis.size)).join(" · ");
      const scale = short(data.scale * fitting(data, context.size), 2);
      const free = data.infinite.length > 0 ? `${sizes ? "; " : ""}infinite along ${data.infinite.length}` : "";
      return `${sizes}${sizes ? `\u00a0${data.unit}, 1\u00a0${data.unit} is ${scale}\u00a0m` : ""}${free}`;
    },
  };
}

function place(object: Mesh | LineLoop, matrix: ReturnType<typeof basis>): void {
  object.matrixAutoUpdate = false;
  object.matrix.copy(matrix);
}

/** Makes the whole drawing smaller where it would hide the robot. */
function fitting(data: Ellipsoid, size: number): number {
  const longest = Math.max(0, ...data.axes.map((axis) => vector(axis.vector).length()));
  return longest > LONGEST * size ? (LONGEST * size) / longest : 1;
}

/** Three semi-axes; those that are missing are thin. */
function threeAxes(data: Ellipsoid, factor: number, thin: number): [Vector3, Vector3, Vector3] {
  const [a, b, c] = data.axes.map((axis) => vector(axis.vector).multiplyScalar(factor));
  const x = a && a.lengthSq() > 0 ? a : new Vector3(thin, 0, 0);
  const y = b && b.lengthSq() > 0 ? b : across(x)[0].multiplyScalar(thin);
  const z = c && c.lengthSq() > 0 ? c : x.clone().cross(y).normalize().multiplyScalar(thin);
  return [x, y, z];
}
