/** The target's position as numbers: the handle for those who do not drag. */
import { h } from "../dom";
import { plain } from "../format";
import type { State, Vec3 } from "../protocol";
import type { Session } from "../session";

export class TargetFields {
  readonly element: HTMLElement;
  private readonly fields: HTMLInputElement[];

  constructor(private readonly session: Session) {
    this.fields = ["x", "y", "z"].map((name) =>
      h("input", { class: "field", type: "number", step: "any", "aria-label": `Target ${name} in world (m)`, "data-target": name, onchange: () => this.send() }),
    );
    this.element = h("div", { class: "line" }, h("span", { class: "note" }, "Target [m]"), h("span", { class: "three" }, ...this.fields));
  }

  show(state: State): void {
    this.fields.forEach((field, i) => {
      if (document.activeElement !== field) field.value = plain(state.target.position[i] ?? 0);
    });
  }

  private send(): void {
    const { state } = this.session;
    const position = this.fields.map((field) => field.valueAsNumber);
    if (!state || !position.every(Number.isFinite)) return;
    this.session.sendSoon("target", { type: "target", position: position as Vec3, quaternion: state.target.quaternion });
  }
}
