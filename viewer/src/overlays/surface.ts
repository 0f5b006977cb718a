/** The cylindroid: the surface that the screws of a two-system sweep, coloured by pitch. */
import {
  BufferGeometry, Color, DoubleSide, Float32BufferAttribute, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, type Group,
} from "three";
import { fixed } from "../format";
import type { Cylindroid } from "../protocol";
import { colour } from "../theme";

const surface = new MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.5, side: DoubleSide, depthWrite: false });
const rulings = new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.75 });

export const cylindroid = {
  colour: "c-cylindroid",
  draw(group: Group, data: Cylindroid): void {
    const [low, high] = [new Color(colour("c-velocity")), new Color(colour("c-active-force"))];
    const [least, largest] = [data.pitches[0] ?? 0, data.pitches[1] ?? 0];
    const shade = (pitch: number | null): Color => {
      const share = largest > least ? ((pitch ?? largest) - least) / (largest - least) : 0.5;
      return low.clone().lerp(high, Math.min(1, Math.max(0, share)));
    };
    const faces: number[] = [];
    const paint: number[] = [];
    const lines: number[] = [];
    const linePaint: number[] = [];
    data.rulings.forEach((ruling, i) => {
      const next = data.rulings[i + 1] ?? swapped(data.rulings[0]);
      const own = shade(ruling.pitch).toArray();
      if (i % 5 === 0) {
        lines.push(...ruling.from, ...ruling.to);
        linePaint.push(...own, ...own);
      }
      if (!next) return;
      const other = shade(next.pitch).toArray();
      faces.push(...ruling.from, ...ruling.to, ...next.from, ...next.from, ...ruling.to, ...next.to);
      paint.push(...own, ...own, ...other, ...other, ...own, ...other);
    });
    group.add(new Mesh(geometry(faces, paint), surface), new LineSegments(geometry(lines, linePaint), rulings));
  },
  words: (data: Cylindroid) =>
    `of the ${data.of === "system" ? "system" : "reciprocal system"}; pitch ${fixed(data.pitches[0], 3)} (blue) to ${fixed(data.pitches[1], 3)} m/rad (orange)`,
};

function swapped(ruling: Cylindroid["rulings"][number] | undefined): Cylindroid["rulings"][number] | undefined {
  return ruling && { ...ruling, from: ruling.to, to: ruling.from };
}

function geometry(points: number[], colours: number[]): BufferGeometry {
  const made = new BufferGeometry();
  made.setAttribute("position", new Float32BufferAttribute(points, 3));
  made.setAttribute("color", new Float32BufferAttribute(colours, 3));
  return made;
}
