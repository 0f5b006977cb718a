/** A grid on the floor that fades outwards; its spacing is a round number of metres. */
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, type Color } from "three";

export type Ground = { object: LineSegments; paint: (line: Color, strong: Color) => void };

const PIECES = 24; // of a line: each end has its own transparency

export function ground(size: number): Ground {
  const spacing = 10 ** Math.round(Math.log10(size / 6));
  const half = Math.min(40, Math.ceil((2.2 * size) / spacing));
  const radius = half * spacing;
  const positions: number[] = [];
  const strong: boolean[] = [];
  for (let i = -half; i <= half; i += 1) {
    for (let piece = 0; piece < PIECES; piece += 1) {
      const from = radius * ((2 * piece) / PIECES - 1);
      const to = radius * ((2 * (piece + 1)) / PIECES - 1);
      positions.push(i * spacing, from, 0, i * spacing, to, 0);
      positions.push(from, i * spacing, 0, to, i * spacing, 0);
      for (let end = 0; end < 4; end += 1) strong.push(i % 5 === 0);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  const colours = new BufferAttribute(new Float32Array(strong.length * 4), 4);
  geometry.setAttribute("color", colours);
  const object = new LineSegments(
    geometry,
    new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }),
  );
  const paint = (line: Color, main: Color): void => {
    strong.forEach((isMain, i) => {
      const distance = Math.hypot(positions[3 * i] ?? 0, positions[3 * i + 1] ?? 0) / radius;
      const { r, g, b } = isMain ? main : line;
      colours.setXYZW(i, r, g, b, Math.max(0, 1 - distance) ** 1.4 * (isMain ? 0.8 : 0.7));
    });
    colours.needsUpdate = true;
  };
  return { object, paint };
}
