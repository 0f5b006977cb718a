/** The way of the tool through a recording, as a line in the view. */
import { Group } from "three";
import { clearCurves, curve, curvePaint } from "../scene/curve";
import type { Columns } from "./columns";

/** Samples closer than this share of the robot's size make no point of the line. */
const CLOSE = 5e-4;
const WIDTH = 2.5; // pixels

export class Trail {
  readonly group = new Group();
  private readonly paint = curvePaint("c-principal", WIDTH, { depthTest: false, depthWrite: false, transparent: true, opacity: 0.85 });

  clear(): void {
    clearCurves(this.group);
  }

  /** `size`: of the robot (m). */
  draw(columns: Columns, size: number): void {
    this.clear();
    const points = wayOf(columns, CLOSE * size);
    if (points.length < 6) return;
    const line = curve(points, this.paint);
    line.renderOrder = 1;
    this.group.add(line);
  }
}

/** Coordinates of the points, one after the other. */
function wayOf({ tool, time }: Columns, close: number): number[] {
  const points: number[] = [];
  for (let i = 0; i < time.length; i += 1) {
    const [x = NaN, y = NaN, z = NaN] = tool.map((column) => column.at(i));
    const last = points.length - 3;
    const way = Math.hypot(x - (points[last] ?? Infinity), y - (points[last + 1] ?? Infinity), z - (points[last + 2] ?? Infinity));
    if (way > close) points.push(x, y, z);
  }
  return points;
}
