/** The target's position as number fields, an alternative to dragging. */
import { h } from "../dom";
import { plain } from "../format";
import type { State, Vec3 } from "../protocol";
import type { Session } from "../session";

export class TargetFields {
  readonly element: HTMLElement;
  private readonly fields: HTMLInputElement[];

  constructor(private readonly session: Session) {
    this.fields = ["x", "y", "z"].map((name, i) =>
      h("input", { class: "field", type: "number", step: "any", "aria-label": `Target ${name} in the world frame (m)`, "data-target": name, onchange: () => this.send(i) }),
    );
    this.element = h("div", { class: "line" }, h("span", { class: "note" }, "Target [m]"), h("span", { class: "three" }, ...this.fields));
  }

  show(state: State): void {
    this.fields.forEach((field, i) => {
      if (document.activeElement !== field) field.value = plain(state.target.position[i] ?? 0);
    });
  }

  /** The fields show fewer digits than the target has: those that nobody typed stay as they are. */
  private send(typed: number): void {
    const { state } = this.session;
    const value = this.fields[typed]?.valueAsNumber ?? NaN;
    if (!state || !Number.isFinite(value)) return;
    const { position, quaternion } = state.target;
    this.session.sendSoon("target", { type: "target", position: position.map((was, i) => (i === typed ? value : was)) as Vec3, quaternion });
  }
}
