/** Singular values as bars on a logarithmic scale, with the threshold below which they count as lost. */
import { fill, h, s } from "../dom";
import { short } from "../format";
import type { Scene, Singular, State } from "../protocol";
import { empty, pairs, panel, type Panel } from "./panel";

const LEFT = 24;
const RIGHT = 62;
const ROW = 17;
const TICK = 34; // room of a number below the bars
const DECADES = 5; // below the largest value

export function singularPanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("singular", "Singular values", true);
  return {
    ...made,
    show(scene, state) {
      const { singular } = state;
      made.note(singular ? `rank ${singular.rank} of ${scene.task.components.length}` : "");
      if (!singular) {
        fill(made.body, empty(state.servo.sentence));
        return;
      }
      fill(
        made.body,
        bars(singular, Math.max(made.body.clientWidth - 28, 180)),
        pairs(
          ["rank", String(singular.rank)],
          ["gap (smallest kept / largest lost)", singular.gap !== null ? short(singular.gap) : singular.rank < singular.values.length ? "∞" : "none lost"],
          ["smallest / largest", short(singular.ratio)],
          ["threshold", short(singular.threshold)],
        ),
        h("p", { class: "note" }, `Task Jacobian (${scene.task.components.join(", ")}), linear rows relative to ${short(singular.length)} m`),
      );
    },
  };
}

function bars(singular: Singular, width: number): SVGElement {
  const all = Math.max(0, ...singular.values);
  const largest = all > 0 ? Math.max(all, singular.threshold) : 1;
  const threshold = Math.max(singular.threshold, 1e-12 * largest);
  const top = Math.ceil(Math.log10(largest) + 1e-9);
  const decades = Math.max(DECADES, Math.ceil(top - Math.log10(threshold) + 0.3));
  const bottom = top - decades;
  const across = width - LEFT - RIGHT;
  const x = (value: number): number => LEFT + (Math.max(0, Math.log10(Math.max(value, 1e-300)) - bottom) / decades) * across;
  const height = singular.values.length * ROW + 32;
  const foot = singular.values.length * ROW + 4;
  const every = Math.ceil((TICK * decades) / across);
  const ticks = Array.from({ length: decades + 1 }, (_, i) => bottom + i).filter((power) => (power - bottom) % every === 0);
  const line = x(threshold);
  return s(
    "svg",
    { class: "bars", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Singular values ${singular.values.map((v) => short(v)).join(", ")}; threshold ${short(singular.threshold)}` },
    ...ticks.map((power) => s("line", { class: "tick", x1: x(10 ** power), x2: x(10 ** power), y1: 0, y2: foot })),
    ...ticks.map((power) => s("text", { x: x(10 ** power), y: foot + 13, "text-anchor": "middle" }, power === 0 ? "1" : power === 1 ? "10" : `1e${String(power).replace("-", "−")}`)),
    ...singular.values.flatMap((value, i) => {
      const lost = value < singular.threshold;
      const y = i * ROW + 3;
      return [
        s("text", { x: LEFT - 6, y: y + 10, "text-anchor": "end" }, `σ${subscript(i + 1)}`),
        s("rect", { class: lost ? "bar-lost" : "bar-kept", x: LEFT, y, width: Math.max(x(value) - LEFT, 1), height: ROW - 5, rx: 2 }),
        s("text", { class: "figure", x: width, y: y + 10, "text-anchor": "end" }, `${short(value)}${lost ? " lost" : ""}`),
      ];
    }),
    s("line", { class: "threshold", x1: line, x2: line, y1: 0, y2: foot + 2 }),
    s("text", { class: "threshold-label", x: line, y: foot + 26, "text-anchor": line > width / 2 ? "end" : "start" }, "threshold"),
  );
}

function subscript(number: number): string {
  return [...String(number)].map((digit) => String.fromCharCode(0x2080 + Number(digit))).join("");
}
