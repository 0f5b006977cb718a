/** Buttons over the view: what the handle does, and from where one looks. */
import { h, text, type Child } from "../dom";
import { icon } from "../icons";
import type { Scene } from "../protocol";
import type { Stage, View } from "../scene/stage";
import type { Mode, Target } from "../target";

/** Each has its number as a key. */
const VIEWS: { view: View; title: string }[] = [
  { view: "corner", title: "From a corner (1)" },
  { view: "front", title: "From the front, along y (2)" },
  { view: "side", title: "From the side, against x (3)" },
  { view: "top", title: "From above, against z (4)" },
];

export class Tools {
  private readonly modes = {
    translate: small("Move (W)", () => this.setMode("translate"), icon("move"), "Move"),
    rotate: small("Rotate (E)", () => this.setMode("rotate"), icon("rotate"), "Rotate"),
  };
  private readonly space = small("Drag along the axes of the tool (X)", () => this.swapSpace(), "tool axes");
  /** What the handle is on. */
  private readonly handles = {
    target: small(null, () => this.handle("target"), "target"),
    point: small(null, () => this.handle("point"), "reference point"),
    obstacle: small(null, () => undefined, "obstacle"),
  };
  private readonly flat = small("Orthographic projection (O)", () => this.swapProjection(), "orthographic");
  private hasPoint = false;
  private inTool = false;
  private turns = true;

  /** `released` is called when the handle is back on the target. */
  constructor(tools: HTMLElement, private readonly target: Target, private readonly stage: Stage, fit: () => void, private readonly released: () => void) {
    const group = (label: string, buttons: HTMLElement[]): HTMLElement => h("span", { class: "group", role: "group", "aria-label": label }, ...buttons);
    tools.append(
      h("span", { class: "float-row" }, group("Handle", Object.values(this.modes)), this.space, group("Dragged handle", Object.values(this.handles))),
      h(
        "span", { class: "float-row" },
        this.flat,
        group("View direction", VIEWS.map(({ view, title }) => h("button", { class: "button small", type: "button", title, onclick: () => stage.view(view) }, view))),
        h("button", { class: "button small", type: "button", title: "Show all (F)", "aria-label": "Show all", onclick: fit }, icon("fit")),
      ),
    );
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
      const looked = VIEWS[Number(event.key) - 1];
      if (looked) stage.view(looked.view);
      if (event.key === "o") this.swapProjection();
      if (event.key === "w") this.setMode("translate");
      else if (event.key === "e" && this.mayTurn()) this.setMode("rotate");
      else if (event.key === "Escape") this.handle("target");
      else if (event.key === "x") this.swapSpace();
      else if (event.key === "f") fit();
    });
    stage.onEye(() => this.paint());
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

  private swapProjection(): void {
    this.stage.setOrthographic(!this.stage.isOrthographic);
  }

  private swapSpace(): void {
    this.inTool = !this.inTool;
    this.target.setSpace(this.inTool ? "local" : "world");
    this.paint();
  }

  private paint(): void {
    const { mode, handle: now, obstacle } = this.target;
    const { target, point, obstacle: held } = this.handles;
    for (const [name, button] of Object.entries(this.modes)) press(button, mode === name);
    this.modes.rotate.disabled = !this.mayTurn();
    press(this.space, this.inTool);
    press(this.flat, this.stage.isOrthographic);
    press(target, now === "target");
    press(point, now === "point");
    press(held, obstacle !== null);
    text(held, obstacle ?? "obstacle");
    target.hidden = !this.hasPoint && obstacle === null;
    point.hidden = !this.hasPoint;
    held.hidden = obstacle === null;
    const focused = Object.values(this.handles).find((button) => button === document.activeElement);
    if (focused?.hidden) this.modes.translate.focus();
  }
}

function small(title: string | null, work: () => void, ...children: Child[]): HTMLButtonElement {
  return h("button", { class: "button small", type: "button", "aria-pressed": "false", title, onclick: work }, ...children);
}

function press(button: HTMLButtonElement, pressed: boolean): void {
  button.setAttribute("aria-pressed", String(pressed));
}

/** Whether a key belongs to the field in focus. */
export function isTyping(target: EventTarget | null): boolean {
  return target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type !== "range" && target.type !== "checkbox");
}
