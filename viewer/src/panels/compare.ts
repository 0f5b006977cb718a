/** Two inverses side by side, and their joint velocities for a moved reference point. */
import { fill, h, Kept } from "../dom";
import { fixed, short } from "../format";
import type { Comparison, Scene, Vec3 } from "../protocol";
import type { Session } from "../session";
import { QuantityField } from "../quantity_field";
import { withUnit } from "../units";
import { empty, panel, type Panel } from "./panel";

const PAUSE = 200;

export class Compare {
  readonly panel: Panel = panel("compare", "Compare inverses", false);
  point: Vec3 | null = null;
  private readonly first = h("select", { class: "select", "aria-label": "First inverse" });
  private readonly second = h("select", { class: "select", "aria-label": "Second inverse" });
  private readonly kept = [this.first, this.second].map((choice) => new Kept(choice));
  private readonly pitch = h("input", { class: "field", type: "number", step: "any", value: "0.1", "aria-label": "Pitch h of hyperbolic inverses (m/rad)" });
  private readonly fields = [0, 1, 2].map((i) => new QuantityField("m", (unit) => `Reference point ${"xyz"[i]} (${unit})`, () => this.typed()));
  private readonly pitchRow = h("p", { class: "row" }, h("label", {}, h("span", { class: "note" }, "pitch h"), this.pitch, h("span", { class: "unit" }, "m/rad")));
  private readonly form: HTMLElement;
  private readonly result = h("div", {});
  private timer = 0;
  private asked: number | null = null;
  /** The first question of this scene: answers to those before may be of another frame or model. */
  private oldest: number | null = null;
  /** What was asked last: an answer to the same would be the same. */
  private question = "";

  constructor(private readonly session: Session, private readonly pointMoved: (point: Vec3 | null) => void) {
    for (const choice of [this.first, this.second]) choice.addEventListener("change", () => this.later());
    this.pitch.addEventListener("input", () => this.later());
    this.form = h(
      "div", {},
      h("p", { class: "pair" }, this.first, this.second),
      this.pitchRow,
      withUnit(h("h3", {}), "m", (unit) => `Reference point in the world frame [${unit}]; can be dragged in the view`),
      h("p", { class: "three" }, ...this.fields.map(({ element }) => element)),
    );
    this.panel.body.append(this.form, this.result);
    this.panel.onToggle((open) => {
      this.pointMoved(open && !this.session.scene?.closed ? this.point : null);
      this.later();
    });
    session.on("compare", (comparison) => {
      const { reply_to } = comparison;
      if (typeof reply_to === "number" && this.oldest !== null && reply_to >= this.oldest) this.show(comparison);
    });
    session.on("state", () => this.later());
    session.on("failure", ({ reply_to, message }) => {
      if (reply_to !== this.asked) return;
      fill(this.result, empty(message));
      // The next state asks again: what refused it may have passed.
      this.question = "";
    });
  }

  /** Choices of a scene; the point starts next to the tool. */
  offer(scene: Scene): void {
    [this.question, this.asked, this.oldest] = ["", null, null];
    this.form.hidden = scene.closed;
    if (scene.closed) {
      this.point = null;
      fill(this.result, empty("For serial arms and trees only; inverses of closed chains are not compared."));
      this.pointMoved(null);
      return;
    }
    const names = scene.methods.map((method) => method.name);
    const old = [this.first.value, this.second.value];
    [this.first, this.second].forEach((choice, i) => {
      this.kept[i]?.fill(names, () => names.map((name) => h("option", { value: name }, name.replaceAll("-", " "))));
      const preferred = [old[i], i === 0 ? "truncated" : "hyperbolic", names[i]].find((name) => name && names.includes(name));
      choice.value = preferred ?? names[0] ?? "";
    });
    this.later();
  }

  movePoint(point: Vec3): void {
    this.point = point;
    this.fields.forEach((field, i) => field.show(point[i] ?? 0));
    this.later();
  }

  owns(id: unknown): boolean {
    return id !== null && id === this.asked;
  }

  private typed(): void {
    const values = this.fields.map((field) => field.value);
    if (values.some((value) => !Number.isFinite(value))) return;
    this.point = values as Vec3;
    this.pointMoved(this.point);
    this.later();
  }

  private later(): void {
    if (this.timer || !this.panel.isOpen()) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.ask();
    }, PAUSE);
  }

  private ask(): void {
    const { scene, state } = this.session;
    if (!scene || !state || scene.closed || !this.panel.isOpen()) return;
    if (!this.point) {
      const [x, y, z] = state.tool.position;
      this.movePoint([x, y - 0.25 * scene.reach, z]);
      this.pointMoved(this.point);
    }
    const h = this.pitch.valueAsNumber;
    const chosen = scene.methods.filter(({ name }) => name === this.first.value || name === this.second.value);
    this.pitchRow.hidden = !chosen.some((method) => method.pitch);
    const asked = {
      type: "compare" as const, methods: [this.first.value, this.second.value] as [string, string], point: this.point ?? [0, 0, 0] as Vec3,
      h: Number.isFinite(h) && !this.pitchRow.hidden ? h : null, twist: null,
    };
    const question = JSON.stringify([asked, state.q, state.target]);
    if (question === this.question) return;
    this.asked = this.session.send(asked);
    this.oldest ??= this.asked;
    this.question = this.asked === null ? "" : question;
  }

  private show(comparison: Comparison): void {
    const { names, results } = comparison;
    const head = h("tr", {}, h("td", {}), ...results.map((result) => h("th", { colspan: 2, scope: "colgroup" }, result.method.replaceAll("-", " "))));
    const under = h("tr", {}, h("td", {}), ...results.flatMap(() => [h("th", { scope: "col" }, "tool"), h("th", { scope: "col" }, "point")]));
    const rows = names.map((name, i) =>
      h("tr", {}, h("th", { scope: "row", class: "cut", title: name }, name), ...results.flatMap((r) => [h("td", {}, fixed(r.joint_velocities?.[i], 3)), h("td", {}, fixed(r.joint_velocities_at_point?.[i], 3))])),
    );
    fill(
      this.result,
      h("h3", {}, "Joint velocities [rad/s, m/s] for the same motion, at the tool and at the point"),
      h("div", { class: "scroll" }, h("table", { class: "numbers" }, h("caption", { class: "hidden-label" }, "Joint velocities of both inverses"), h("thead", {}, head, under), h("tbody", {}, ...rows))),
      ...results.map((result) =>
        h("p", {}, h("b", {}, `${result.method.replaceAll("-", " ")}: `),
          !result.exists ? h("span", { class: "verdict bad" }, "does not exist") :
          result.invariant ? h("span", { class: "verdict good" }, "independent of the point") :
          h("span", { class: "verdict bad" }, `depends on the point: difference ${short(result.difference)}`),
          result.reason ? h("span", { class: "note" }, ` ${result.reason}`) : null)),
      h("p", { class: "note" }, `Desired twist at the tool, world axes: v ${triple(comparison.twist.slice(0, 3))} m/s, w ${triple(comparison.twist.slice(3))} rad/s`),
    );
  }
}

function triple(values: number[]): string {
  return `(${values.map((value) => fixed(value, 3)).join(", ")})`;
}
