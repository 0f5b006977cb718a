/** Singular values as bars on a logarithmic scale, with the threshold below which they count as lost. */
import { h, Kept, s, text } from "../dom";
import { short } from "../format";
import type { Scene, Singular, State } from "../protocol";
import { facts, panel, type Panel } from "./panel";

const LEFT = 24;
const RIGHT = 62;
const ROW = 17;
const TICK = 34; // room of a number below the bars
const DECADES = 5; // below the largest value
const MARGINS = 28; // of a panel's body

/** `resized`: the room of the bars is another one. */
export function singularPanel(resized: () => void): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("singular", "Singular values", true);
  const bars = new Bars();
  const none = h("p", { class: "empty" });
  const known = facts(["rank", "gap (smallest kept / largest lost)", "smallest / largest", "threshold"]);
  const basis = h("p", { class: "note" });
  const all = h("div", {}, bars.element, known.element, basis);
  made.body.append(none, all);
  // Asked for with each state, the width would be laid out with each.
  let width = 0;
  new ResizeObserver(() => {
    const now = made.body.clientWidth - MARGINS;
    if (now <= 0 || now === width) return;
    width = now;
    resized();
  }).observe(made.body);
  return {
    ...made,
    show(scene, state) {
      const { singular } = state;
      made.note(singular ? `rank ${singular.rank} of ${scene.task.components.length}` : "");
      if (!made.isOpen()) return;
      none.hidden = singular !== null;
      all.hidden = singular === null;
      if (!singular) {
        text(none, state.servo.sentence);
        return;
      }
      bars.show(singular, Math.max(width || made.body.clientWidth - MARGINS, 180));
      known.set(0, String(singular.rank));
      known.set(1, singular.gap !== null ? short(singular.gap) : singular.rank < singular.values.length ? "∞" : "none lost");
      known.set(2, short(singular.ratio));
      known.set(3, short(singular.threshold));
      text(basis, `Task Jacobian (${scene.task.components.join(", ")}), linear rows relative to ${short(singular.length)} m`);
    },
  };
}

type Bar = { body: SVGElement; figure: SVGElement };

/** The drawing: its scale is built anew where it changes, otherwise only lengths and figures are set. */
class Bars {
  readonly element = s("svg", { class: "bars", role: "img" });
  private readonly kept = new Kept(this.element);
  private readonly line = s("line", { class: "threshold", y1: 0 });
  private readonly label = s("text", { class: "threshold-label" }, "threshold");
  private bars: Bar[] = [];

  show(singular: Singular, width: number): void {
    const { values } = singular;
    const most = Math.max(0, ...values);
    const largest = most > 0 ? Math.max(most, singular.threshold) : 1;
    const threshold = Math.max(singular.threshold, 1e-12 * largest);
    const top = Math.ceil(Math.log10(largest) + 1e-9);
    const decades = Math.max(DECADES, Math.ceil(top - Math.log10(threshold) + 0.3));
    const bottom = top - decades;
    const across = width - LEFT - RIGHT;
    const x = (value: number): number => LEFT + (Math.max(0, Math.log10(Math.max(value, 1e-300)) - bottom) / decades) * across;
    const foot = values.length * ROW + 4;
    this.kept.fill([values.length, width, bottom, decades], () => {
      const every = Math.ceil((TICK * decades) / across);
      const ticks = Array.from({ length: decades + 1 }, (_, i) => bottom + i).filter((power) => (power - bottom) % every === 0);
      set(this.element, { viewBox: `0 0 ${width} ${foot + 28}` });
      set(this.line, { y2: foot + 2 });
      set(this.label, { y: foot + 26 });
      this.bars = values.map((_, i) => ({
        body: s("rect", { x: LEFT, y: i * ROW + 3, height: ROW - 5, rx: 2 }),
        figure: s("text", { class: "figure", x: width, y: i * ROW + 13, "text-anchor": "end" }),
      }));
      return [
        ...ticks.map((power) => s("line", { class: "tick", x1: x(10 ** power), x2: x(10 ** power), y1: 0, y2: foot })),
        ...ticks.map((power) => s("text", { x: x(10 ** power), y: foot + 13, "text-anchor": "middle" }, power === 0 ? "1" : power === 1 ? "10" : `1e${String(power).replace("-", "−")}`)),
        ...this.bars.flatMap(({ body, figure }, i) => [s("text", { x: LEFT - 6, y: i * ROW + 13, "text-anchor": "end" }, `σ${subscript(i + 1)}`), body, figure]),
        this.line, this.label,
      ];
    });
    const line = x(threshold);
    set(this.line, { x1: line, x2: line });
    set(this.label, { x: line, "text-anchor": line > width / 2 ? "end" : "start" });
    set(this.element, { "aria-label": `Singular values ${values.map((v) => short(v)).join(", ")}; threshold ${short(singular.threshold)}` });
    this.bars.forEach(({ body, figure }, i) => {
      const value = values[i] ?? 0;
      const lost = value < singular.threshold;
      set(body, { class: lost ? "bar-lost" : "bar-kept", width: Math.max(x(value) - LEFT, 1) });
      text(figure, `${short(value)}${lost ? " lost" : ""}`);
    });
  }
}

function set(element: Element, attributes: Record<string, string | number>): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (element.getAttribute(name) !== String(value)) element.setAttribute(name, String(value));
  }
}

function subscript(number: number): string {
  return [...String(number)].map((digit) => String.fromCharCode(0x2080 + Number(digit))).join("");
}
