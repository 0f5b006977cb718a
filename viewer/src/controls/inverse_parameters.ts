/** The parameters of the chosen inverse; they are sent together when one is changed. */
import { h, Kept } from "../dom";
import type { Method, Scene } from "../protocol";
import type { Session } from "../session";

export class InverseParameters {
  readonly element = h("div", {});
  private readonly kept = new Kept(this.element);
  private fields = new Map<string, HTMLInputElement>();
  private pitch: HTMLInputElement | null = null;

  constructor(private readonly session: Session) {}

  build({ method: now, methods }: Scene): void {
    const method = methods.find(({ name }) => name === now.name);
    this.kept.fill([method, now.fallback], () => {
      this.fields = new Map(method?.parameters.map(({ name }) => [name, this.field()]));
      this.pitch = method?.pitch ? this.field() : null;
      return [
        ...(method?.parameters ?? []).map(({ name, unit, description }) => line(unit === "-" ? name : `${name} [${unit}]`, description, this.fields.get(name) ?? null)),
        this.pitch && line("pitch h [m/rad]", "Pitch of the form", this.pitch),
        this.pitch && now.fallback && h("p", { class: "note" }, `Fallback if it does not exist: ${now.fallback}`),
      ];
    });
    for (const [name, value] of Object.entries(valuesOf(method, now.parameters))) show(this.fields.get(name), value);
    show(this.pitch, now.h);
  }

  private field(): HTMLInputElement {
    const field = h("input", { class: "field", type: "number", step: "any", onchange: () => {
      if (Number.isFinite(field.valueAsNumber)) this.send();
    } });
    return field;
  }

  private send(): void {
    const { scene } = this.session;
    if (!scene) return;
    const { name, h: pitch, fallback, parameters } = scene.method;
    const values = valuesOf(scene.methods.find((other) => other.name === name), parameters);
    for (const [key, field] of this.fields) if (Number.isFinite(field.valueAsNumber)) values[key] = field.valueAsNumber;
    const typed = this.pitch?.valueAsNumber ?? NaN;
    this.session.send({ type: "method", name, parameters: values, h: Number.isFinite(typed) ? typed : pitch, fallback });
  }
}

/** Those in effect, defaults included. */
function valuesOf(method: Method | undefined, now: Record<string, number>): Record<string, number> {
  return { ...Object.fromEntries(method?.parameters.map(({ name, default: usual }) => [name, usual]) ?? []), ...now };
}

function line(label: string, title: string, field: HTMLInputElement | null): HTMLElement {
  return h("label", { class: "line", title }, h("span", { class: "note" }, label.replaceAll("_", " ")), field);
}

function show(field: HTMLInputElement | null | undefined, value: number | null): void {
  if (field && document.activeElement !== field) field.value = value === null ? "" : String(value);
}
