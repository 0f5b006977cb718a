/** Moves the tool while a button or key is held: a twist in world axes, which the servo follows. */
import { fill, h, text } from "../dom";
import { short } from "../format";
import type { Scene, State, Vec3 } from "../protocol";
import type { Session } from "../session";

/** Commands repeat this often (ms); the server stops without one for 250 ms. */
const PERIOD = 50;
/** Full speeds: of lengths a second, in characteristic lengths, and rad/s. */
const LINEAR = 0.25;
const ANGULAR = 0.6;
const AXES = ["x", "y", "z"] as const;
const KEYS: Record<string, [number, number]> = {
  ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1],
};

export class VelocityPad {
  readonly element: HTMLElement;
  private readonly buttons = h("div", { class: "pad" });
  private readonly turn: HTMLInputElement;
  private readonly speed: HTMLInputElement;
  private readonly note = h("span", { class: "note" });
  /** Axis and sign of everything held, by key or button. */
  private readonly held = new Map<string, [number, number]>();
  private timer: number | undefined;
  private turning = false;
  private built = "";

  constructor(private readonly session: Session) {
    this.turn = h("input", { type: "checkbox" });
    this.turn.addEventListener("change", () => this.release());
    this.speed = h("input", { type: "range", min: "0.1", max: "1", step: "0.1", value: "0.5", "aria-label": "Speed" });
    const keys = "Arrow keys move the tool along x and y, Page Up and Page Down along z; with Shift they rotate it";
    const paint = (): void => this.speed.style.setProperty("--filled", `${100 * this.speed.valueAsNumber}%`);
    this.speed.addEventListener("input", paint);
    paint();
    this.element = h(
      "div", { class: "velocity", role: "group", tabindex: "0", "aria-label": `Hold to move. ${keys}.`, title: keys },
      h("div", { class: "line" }, h("span", { class: "note" }, "Hold to move"), h("label", { class: "note" }, this.turn, " rotate")),
      this.buttons,
      h("label", { class: "line" }, h("span", { class: "note" }, "Speed"), this.speed),
      this.note,
    );
    this.element.addEventListener("keydown", (event) => this.press(event));
    this.element.addEventListener("keyup", (event) => this.lift(event.key));
    this.element.addEventListener("focusout", ({ relatedTarget }) => {
      if (!(relatedTarget instanceof Node && this.element.contains(relatedTarget))) this.release();
    });
    addEventListener("blur", () => this.release());
    session.on("link", () => this.release());
  }

  build(scene: Scene): void {
    const components = scene.task.components;
    const key = components.join();
    if (key === this.built) return;
    this.built = key;
    this.turn.disabled = !components.some((name) => name.startsWith("r"));
    fill(
      this.buttons,
      ...[-1, 1].flatMap((sign) => AXES.map((name, axis) => {
        const label = `${sign < 0 ? "−" : "+"}${name}`;
        const button = h("button", { class: "button small", type: "button", "aria-label": `Move ${label}`, tabindex: "-1" }, label);
        const id = `${axis}${sign}`;
        button.addEventListener("pointerdown", (event) => {
          button.setPointerCapture(event.pointerId);
          this.hold(id, axis, sign, this.turn.checked);
        });
        for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) button.addEventListener(end, () => this.drop(id));
        return button;
      })),
    );
  }

  show(state: State): void {
    const twist = state.servo.twist;
    const size = twist ? [Math.hypot(...twist.slice(0, 3)), Math.hypot(...twist.slice(3))] : null;
    text(this.note, size ? `commanded ${short(size[0])} m/s, ${short(size[1])} rad/s` : "");
  }

  private press(event: KeyboardEvent): void {
    const found = KEYS[event.key];
    if (!found || event.ctrlKey || event.metaKey || event.altKey || event.target === this.speed) return;
    event.preventDefault();
    event.stopPropagation();
    this.hold(event.key, found[0], found[1], event.shiftKey || this.turn.checked);
  }

  private lift(key: string): void {
    if (key === "Shift") this.release();
    else this.drop(key);
  }

  private hold(id: string, axis: number, sign: number, turning: boolean): void {
    if (turning !== this.turning) this.held.clear();
    this.turning = turning && !this.turn.disabled;
    this.held.set(id, [axis, sign]);
    if (this.timer === undefined) {
      this.timer = window.setInterval(() => this.send(), PERIOD);
      this.send();
    }
  }

  private drop(id: string): void {
    if (this.held.delete(id) && this.held.size === 0) this.release();
  }

  /** Lets go of everything: the tool brakes. */
  private release(): void {
    this.held.clear();
    if (this.timer === undefined) return;
    clearInterval(this.timer);
    this.timer = undefined;
    this.send();
  }

  private send(): void {
    const scene = this.session.scene;
    if (!scene) return;
    const share = this.speed.valueAsNumber;
    const way: Vec3 = [0, 0, 0];
    for (const [axis, sign] of this.held.values()) way[axis] = (way[axis] ?? 0) + sign * share;
    const at = (on: boolean, size: number): Vec3 => (on ? [size * way[0], size * way[1], size * way[2]] : [0, 0, 0]);
    this.session.send({ type: "twist", linear: at(!this.turning, LINEAR * scene.reach), angular: at(this.turning, ANGULAR) });
  }
}
