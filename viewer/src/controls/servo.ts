/** The servo: target, held buttons, controlled frame, task components, inverse. */
import { h } from "../dom";
import { panel } from "../panels/panel";
import type { Scene, State } from "../protocol";
import type { Session } from "../session";
import { Choice, type Option } from "./choice";
import { InverseParameters } from "./inverse_parameters";
import { PoseFields } from "./pose_fields";
import { VelocityPad } from "./velocity_pad";

const TASKS: Option[] = [
  ["pose", "full pose"],
  ["position", "position only"],
  ["orientation", "orientation only"],
  ["pointing", "position and pointing direction"],
];
const PITCH = 0.1;

export class ServoControls {
  readonly panel = panel("servo", "Servo", true);
  private readonly target = new PoseFields(
    { label: (part) => `Target ${part} in the world frame`, mark: (part) => ({ "data-target": part }), orientation: true },
    (pose) => this.session.sendSoon("target", { type: "target", ...pose }),
  );
  private readonly pad: VelocityPad;
  private readonly frame = new Choice("Frame", (name) => this.session.send({ type: "frame", name }));
  private readonly task = new Choice("Task", (name) => this.session.send({ type: "task", name }));
  private readonly inverse = new Choice("Inverse", (name) => this.choose(name));
  private readonly parameters: InverseParameters;
  private readonly needsAll = h("p", { class: "note" }, "Hyperbolic inverses require a task of all six components; Compare always offers them.");

  constructor(private readonly session: Session) {
    this.pad = new VelocityPad(session);
    this.parameters = new InverseParameters(session);
    this.panel.body.append(h("h3", {}, "Target"), this.target.element, ...[this.pad, this.frame, this.task, this.inverse, this.parameters].map(({ element }) => element), this.needsAll);
  }

  show(state: State): void {
    if (!this.panel.isOpen()) return;
    this.target.show(state.target);
    this.pad.show(state);
  }

  build(scene: Scene): void {
    const { method, methods, task } = scene;
    this.panel.note(method.name.replaceAll("-", " "));
    this.pad.build(scene);
    this.frame.show(scene.frames.map(({ name }) => [name, name]), scene.frame);
    this.task.show(TASKS.some(([name]) => name === task.name) ? TASKS : [...TASKS, [task.name, task.name]], task.name);
    this.inverse.show(methods.filter(({ servo }) => servo).map(({ name }) => [name, name.replaceAll("-", " ")]), method.name);
    this.parameters.build(scene);
    this.needsAll.hidden = methods.every(({ servo }) => servo);
  }

  private choose(name: string): void {
    const { scene } = this.session;
    const method = scene?.methods.find((other) => other.name === name);
    if (!scene || !method) return;
    const h = method.pitch ? (scene.method.h ?? PITCH) : null;
    this.session.send({ type: "method", name, parameters: {}, h, fallback: method.pitch ? "truncated" : null });
  }
}
