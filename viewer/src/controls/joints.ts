/** A slider for each coordinate, with limits and unit; and for closed chains a switch for each joint that can be actuated. */
import { h, Kept, type Child } from "../dom";
import { fixed } from "../format";
import { panel, type Panel } from "../panels/panel";
import type { Coordinate, Actuator, Scene, State } from "../protocol";
import type { Session } from "../session";
import { digitsOf, inUnits, shown, unitOf, withUnit, type Quantity } from "../units";
import { QuantityField } from "../quantity_field";

/** Where the file gives no limit a slider still needs an end (rad, or share of the reach). */
const FREE_TURN = Math.PI;
/** A slider that was touched is not moved by states for a while (ms). */
const QUIET = 300;

/** More coordinates than these of a closed chain are folded away where they are passive at the start. */
const MANY = 12;

type Row = { element: HTMLElement; slider: HTMLInputElement; field: QuantityField; touched: number };

export class Joints {
  private readonly list = h("div", {});
  private readonly selfMotion = h("div", {});
  private readonly kept = { list: new Kept(this.list), selfMotion: new Kept(this.selfMotion) };
  private rows: Row[] = [];
  private readonly actuators = new Map<string, HTMLInputElement>();
  private selfSlider: HTMLInputElement | null = null;
  private timer = 0;

  constructor(private readonly session: Session, readonly panel = sliders()) {
    this.panel.body.append(this.list, this.selfMotion);
  }

  build(scene: Scene): void {
    const fixedParts = scene.coordinates.map(({ actuated: _, adjustable: __, ...rest }) => rest);
    this.kept.list.fill([scene.name, fixedParts, scene.actuators.map(({ name }) => name)], () => this.rowsOf(scene));
    scene.coordinates.forEach(({ adjustable }, i) => {
      const row = this.rows[i];
      if (row) row.slider.disabled = row.field.element.disabled = !adjustable;
    });
    for (const { name, actuated } of scene.actuators) {
      const box = this.actuators.get(name);
      if (box) box.checked = actuated;
    }
    this.panel.note(`${scene.coordinates.length} coordinates`);
    this.kept.selfMotion.fill(scene.self_motions, () => this.selfMotionParts(scene));
  }

  private rowsOf(scene: Scene): Child[] {
    const actuators = new Map(scene.actuators.map((actuator) => [actuator.name, actuator]));
    const placed = new Set<string>();
    this.actuators.clear();
    this.rows = scene.coordinates.map((coordinate) => {
      const joint = scene.joints[coordinate.joint]?.name ?? coordinate.name;
      const actuator = placed.has(joint) ? undefined : actuators.get(joint);
      placed.add(joint);
      return this.row(scene, coordinate, actuator);
    });
    const closing = scene.actuators.filter((actuator) => !placed.has(actuator.name));
    const split = scene.closed && scene.coordinates.length > MANY;
    const first = this.rows.filter((_, i) => !split || scene.coordinates[i]?.actuated);
    const more = this.rows.filter((_, i) => split && !scene.coordinates[i]?.actuated);
    return [
      scene.coordinates.length === 0 && h("p", { class: "empty" }, "This model has no movable joint."),
      scene.actuators.length > 0 && h("p", { class: "note" }, "The switch before a name selects the joint as actuated."),
      ...first.map((row) => row.element),
      ...closing.map((actuator) => h("div", { class: "joint" }, this.actuatorSwitch(actuator), h("span", { class: "note" }, "loop-closure joint"))),
      more.length > 0 && h("details", { class: "more" }, h("summary", {}, `${more.length} more coordinates`), ...more.map((row) => row.element)),
    ];
  }

  show(state: State): void {
    if (!this.panel.isOpen()) return;
    const now = performance.now();
    const outside = new Set(state.outside_limits);
    this.rows.forEach((row, i) => {
      const value = state.q[i] ?? 0;
      row.element.classList.toggle("outside", outside.has(i));
      if (now - row.touched < QUIET) return;
      setSlider(row.slider, value);
      row.slider.setAttribute("aria-valuetext", inWords(value, row.field.quantity));
      row.field.show(value);
    });
    if (this.selfSlider && document.activeElement !== this.selfSlider) setSlider(this.selfSlider, state.servo.self_motion);
  }

  /** What was asked for may not have been reached: shows what is. */
  private settle(): void {
    if (this.session.state) this.show(this.session.state);
  }

  private row(scene: Scene, coordinate: Coordinate, actuator: Actuator | undefined): Row {
    const { name, unit, adjustable } = coordinate;
    const free = unit === "rad" ? FREE_TURN : scene.reach;
    const [low, high] = [coordinate.lower ?? -free, coordinate.upper ?? free];
    const slider = h("input", { type: "range", min: low, max: high, step: "any", disabled: !adjustable, "data-joint": name });
    const field = new QuantityField(unit, (shownUnit) => `${name} as a number [${shownUnit}]`, (value) => move(value), { disabled: !adjustable });
    const label = actuator ? this.actuatorSwitch(actuator, name) : h("span", { class: "name", title: name }, name);
    const limits = [coordinate.lower, coordinate.upper].map(() => h("span", { class: "limit" }));
    const element = h(
      "div", { class: "joint" },
      label,
      h("span", { class: "value" }, field.element, withUnit(h("span", { class: "unit" }), unit, (shownUnit) => shownUnit)),
      h("div", { class: "track" }, limits[0], slider, limits[1]),
    );
    inUnits(slider, () => {
      slider.setAttribute("aria-label", `${name} [${unitOf(unit)}]`);
      slider.setAttribute("aria-valuetext", inWords(slider.valueAsNumber, unit));
      [coordinate.lower, coordinate.upper].forEach((value, i) => {
        const [end, bound] = [limits[i], value === null ? "" : inLimits(value, unit)];
        if (end) [end.textContent, end.title] = [bound || (i === 0 ? "−∞" : "∞"), bound && `${shown(value ?? 0, unit)} ${unitOf(unit)}`];
        const attribute = i === 0 ? "min" : "max";
        if (value !== null) field.element.setAttribute(attribute, String(shown(value, unit)));
      });
    });
    const row: Row = { element, slider, field, touched: -Infinity };
    const move = (value: number): void => {
      row.touched = performance.now();
      setSlider(slider, value);
      this.session.sendSoon(`joint ${name}`, { type: "joint", name, value });
      clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.settle(), QUIET + 30);
    };
    slider.addEventListener("input", () => {
      field.show(slider.valueAsNumber);
      move(slider.valueAsNumber);
    });
    slider.addEventListener("keydown", (event) => stepByKey(event, slider, (high - low) / 200));
    return row;
  }

  /** The whole set goes to the server: the actuated joints are chosen together. */
  private actuatorSwitch(actuator: Actuator, shown = actuator.name): HTMLElement {
    const box = h("input", { type: "checkbox", class: "switch", role: "switch", "aria-label": `${actuator.name} actuated`, "data-actuator": actuator.name });
    this.actuators.set(actuator.name, box);
    box.addEventListener("change", () => {
      const all = this.session.scene?.actuators ?? [];
      const names = all.filter((other) => (other.name === actuator.name ? box.checked : other.actuated)).map((other) => other.name);
      this.session.send({ type: "actuated", names });
    });
    return h("label", { class: "actuator" }, box, h("span", { class: "name", title: shown }, shown));
  }

  private selfMotionParts(scene: Scene): Child[] {
    this.selfSlider = null;
    if (scene.self_motions === 0) return [];
    const which = h("select", { class: "select", "aria-label": "Which self-motion" }, ...Array.from({ length: scene.self_motions }, (_, i) => h("option", { value: i }, `motion ${i + 1}`)));
    const slider = h("input", { type: "range", min: -1, max: 1, step: "any", "aria-label": "Self-motion: share of the maximum speed" });
    const send = (): void => this.session.sendSoon("null_space", { type: "null_space", rate: slider.valueAsNumber, index: Number(which.value) });
    const rest = (): void => {
      setSlider(slider, 0);
      send();
    };
    setSlider(slider, 0);
    slider.addEventListener("input", () => {
      setSlider(slider, slider.valueAsNumber);
      send();
    });
    slider.addEventListener("keydown", (event) => stepByKey(event, slider, 0.1));
    slider.addEventListener("pointerup", rest);
    slider.addEventListener("blur", rest);
    this.selfSlider = slider;
    return [
      h("h3", {}, "Self-motion (null space)"),
      h("div", { class: "row" }, scene.self_motions > 1 && which),
      slider,
      h("p", { class: "note" }, "Joint motion with the tool at rest: drag the slider to move, release it to stop."),
    ];
  }
}

function sliders(): Panel {
  return panel("joints", "Joints", true);
}

function inWords(value: number, unit: Quantity): string {
  return `${fixed(shown(value, unit), digitsOf(unit, 3))} ${unitOf(unit)}`;
}

/** A limit in as many digits as there is room for. */
function inLimits(value: number, unit: Quantity): string {
  return String(Number(shown(value, unit).toPrecision(5))).replace("-", "−");
}

/** Sliders with step "any" would jump by the browser's own step. */
function stepByKey(event: KeyboardEvent, slider: HTMLInputElement, step: number): void {
  const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
  if (way === undefined) return;
  event.preventDefault();
  const value = slider.valueAsNumber + way * step;
  slider.value = String(Math.min(Number(slider.max), Math.max(Number(slider.min), value)));
  slider.dispatchEvent(new Event("input"));
}

function setSlider(slider: HTMLInputElement, value: number): void {
  slider.value = String(value);
  const [low, high] = [Number(slider.min), Number(slider.max)];
  const share = high > low ? (Math.min(high, Math.max(low, value)) - low) / (high - low) : 0.5;
  slider.style.setProperty("--filled", `${(share * 100).toFixed(2)}%`);
}
