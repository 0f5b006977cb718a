/** Buttons over the view: what the handle does, and from where one looks. */
import { fill, h } from "../dom";
import { icon } from "../icons";
import type { Scene } from "../protocol";
import type { Stage, View } from "../scene/stage";
import type { Mode, Target } from "../target";

const VIEWS: View[] = ["corner", "front", "side", "top"];

export class Tools {
  private readonly modes = h("span", { class: "group", role: "group", "aria-label": "Handle" });
  private readonly handles = h("span", { class: "group", role: "group", "aria-label": "Dragged handle" });
  private readonly space: HTMLButtonElement;
  private hasPoint = false;
  private inTool = false;
  private turns = true;

  /** `released` is called when the handle is back on the target. */
  constructor(tools: HTMLElement, private readonly target: Target, stage: Stage, fit: () => void, private readonly released: () => void) {
    this.space = h("button", { class: "button small", type: "button", "aria-pressed": "false", title: "Drag along the axes of the tool (X)", onclick: () => this.swapSpace() }, "tool axes");
    tools.append(
      h("span", { class: "float-row" }, this.modes, this.space, this.handles),
      h(
        "span", { class: "float-row" },
        h("span", { class: "group", role: "group", "aria-label": "View direction" }, ...VIEWS.map((view) => h("button", { class: "button small", type: "button", onclick: () => stage.view(view) }, view))),
        h("button", { class: "button small", type: "button", title: "Show all (F)", "aria-label": "Show all", onclick: fit }, icon("fit")),
      ),
    );
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
      if (event.key === "w") this.setMode("translate");
      else if (event.key === "e" && this.mayTurn()) this.setMode("rotate");
      else if (event.key === "Escape") this.handle("target");
      else if (event.key === "x") this.swapSpace();
      else if (event.key === "f") fit();
    });
    this.paint();
  }

  build(scene: Scene): void {
    this.turns = scene.task.components.some((name) => name.startsWith("r"));
    if (!this.mayTurn() && this.target.mode === "rotate") this.target.setMode("translate");
    this.paint();
  }

  /** Shows on which obstacle the handle is. */
  held(): void {
    this.paint();
  }

  private mayTurn(): boolean {
    return this.turns || this.target.handle === "obstacle";
  }

  private handle(handle: "target" | "point"): void {
    this.target.setHandle(handle);
    if (!this.mayTurn() && this.target.mode === "rotate") this.target.setMode("translate");
    this.released();
    this.paint();
  }

  /** Whether there is a reference point to drag as well. */
  offerPoint(there: boolean): void {
    if (this.hasPoint === there) return;
    this.hasPoint = there;
    if (!there && this.target.handle === "point") this.target.setHandle("target");
    this.paint();
  }

  private setMode(mode: Mode): void {
    this.target.setMode(mode);
    this.paint();
  }

  private swapSpace(): void {
    this.inTool = !this.inTool;
    this.target.setSpace(this.inTool ? "local" : "world");
    this.paint();
  }

  private paint(): void {
    const modes: [Mode, "move" | "rotate", string, boolean][] = [
      ["translate", "move", "Move (W)", true],
      ["rotate", "rotate", "Rotate (E)", this.mayTurn()],
    ];
    fill(this.modes, ...modes.map(([mode, name, label, there]) =>
      h("button", { class: "button small", type: "button", "aria-pressed": String(this.target.mode === mode), disabled: !there, title: label, onclick: () => this.setMode(mode) }, icon(name), label.split(" ")[0] ?? "")));
    this.space.setAttribute("aria-pressed", String(this.inTool));
    const { handle: now, obstacle } = this.target;
    const button = (label: string, pressed: boolean, choose: () => void): HTMLElement =>
      h("button", { class: "button small", type: "button", "aria-pressed": String(pressed), onclick: choose }, label);
    const there = this.hasPoint || obstacle !== null;
    fill(
      this.handles,
      there && button("target", now === "target", () => this.handle("target")),
      this.hasPoint && button("reference point", now === "point", () => this.handle("point")),
      obstacle !== null && button(obstacle, true, () => undefined),
    );
  }
}

function isTyping(target: EventTarget | null): boolean {
  return target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type !== "range" && target.type !== "checkbox");
}
