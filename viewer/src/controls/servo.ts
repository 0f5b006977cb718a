/** The servo: controlled frame, task components, inverse. */
import { fill, h } from "../dom";
import { panel } from "../panels/panel";
import type { ChosenMethod, Method, Scene, State } from "../protocol";
import type { Session } from "../session";
import { TargetFields } from "./target_fields";
import { VelocityPad } from "./velocity_pad";

const TASKS: [string, string][] = [
  ["pose", "full pose"],
  ["position", "position only"],
  ["orientation", "orientation only"],
  ["pointing", "position and pointing direction"],
];
const PITCH = 0.1;

export class ServoControls {
  readonly panel = panel("servo", "Servo", true);

  private readonly target: TargetFields;
  private readonly pad: VelocityPad;

  constructor(private readonly session: Session) {
    this.target = new TargetFields(session);
    this.pad = new VelocityPad(session);
  }

  show(state: State): void {
    this.target.show(state);
    this.pad.show(state);
  }

  build(scene: Scene): void {
    const { method } = scene;
    const chosen = scene.methods.find((other) => other.name === method.name);
    this.panel.note(method.name.replaceAll("-", " "));
    this.pad.build(scene);
    fill(
      this.panel.body,
      this.target.element,
      this.pad.element,
      this.choice("Frame", scene.frames.map(({ name }) => [name, name]), scene.frame, (name) => this.session.send({ type: "frame", name })),
      this.choice("Task", this.tasks(scene), scene.task.name, (name) => this.session.send({ type: "task", name })),
      this.choice(
        "Inverse",
        scene.methods.filter((other) => other.servo).map(({ name }) => [name, name.replaceAll("-", " ")]),
        method.name,
        (name) => this.choose(scene, name),
      ),
      chosen && this.parameters(chosen, method),
      scene.methods.some((other) => !other.servo) &&
        h("p", { class: "note" }, "Hyperbolic inverses require a task of all six components; Compare always offers them."),
    );
  }

  private tasks(scene: Scene): [string, string][] {
    const known = TASKS.some(([name]) => name === scene.task.name);
    return known ? TASKS : [...TASKS, [scene.task.name, scene.task.name]];
  }

  private choice(label: string, options: [string, string][], value: string, chosen: (value: string) => void): HTMLElement {
    const select = h("select", { class: "select", "aria-label": label }, ...options.map(([name, words]) => h("option", { value: name }, words)));
    select.value = value;
    select.addEventListener("change", () => chosen(select.value));
    return h("label", { class: "line" }, h("span", { class: "note" }, label), select);
  }

  private choose(scene: Scene, name: string): void {
    const method = scene.methods.find((other) => other.name === name);
    if (!method) return;
    const h = method.pitch ? (scene.method.h ?? PITCH) : null;
    this.session.send({ type: "method", name, parameters: {}, h, fallback: method.pitch ? "truncated" : null });
  }

  /** The parameters of the inverse, sent together when one is changed. */
  private parameters(method: Method, now: ChosenMethod): HTMLElement {
    const values: Record<string, number> = { ...now.parameters };
    for (const { name, default: usual } of method.parameters) values[name] ??= usual;
    let pitch = now.h;
    const send = (): void => {
      this.session.send({ type: "method", name: method.name, parameters: values, h: pitch, fallback: now.fallback });
    };
    const field = (label: string, title: string, value: number | null, set: (value: number) => void): HTMLElement => {
      const input = h("input", { class: "field", type: "number", step: "any", value: value ?? "" });
      input.addEventListener("change", () => {
        if (!Number.isFinite(input.valueAsNumber)) return;
        set(input.valueAsNumber);
        send();
      });
      return h("label", { class: "line", title }, h("span", { class: "note" }, label), input);
    };
    return h(
      "div", {},
      ...method.parameters.map(({ name, unit, description }) => {
        const label = unit === "-" ? name : `${name} [${unit}]`;
        return field(label.replaceAll("_", " "), description, values[name] ?? null, (value) => {
          values[name] = value;
        });
      }),
      method.pitch && field("pitch h [m/rad]", "Pitch of the form", pitch, (value) => {
        pitch = value;
      }),
      method.pitch && now.fallback && h("p", { class: "note" }, `Fallback if it does not exist: ${now.fallback}`),
    );
  }
}
