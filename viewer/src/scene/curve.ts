/** Curves of even width in the view, in colours of the style sheet. */
import { Color, type Group } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { colour, onTheme } from "../theme";

/** A paint that follows the theme; `width` in pixels. */
export function curvePaint(name: string, width: number, more: ConstructorParameters<typeof LineMaterial>[0] = {}): LineMaterial {
  const paint = new LineMaterial({ linewidth: width, ...more });
  const wear = (): void => void (paint.color = new Color(colour(name)));
  onTheme(wear);
  wear();
  return paint;
}

/** A curve through these coordinates, three for each point, of two points at least. */
export function curve(coordinates: number[], paint: LineMaterial): Line2 {
  const line = new Line2(new LineGeometry().setPositions(coordinates), paint);
  line.frustumCulled = false;
  return line;
}

/** Takes all curves out of a group of nothing else. */
export function clearCurves(group: Group): void {
  for (const child of [...group.children]) {
    (child as Line2).geometry.dispose();
    child.removeFromParent();
  }
}
