/** Obstacles: added, moved by fields or the handle, removed; and the switch that makes the servo avoid them. */
import { fill, h } from "../dom";
import { panel } from "../panels/panel";
import type { Obstacle, Pose, Scene, SimpleShape, State, Vec3 } from "../protocol";
import type { Session } from "../session";
import { withUnit } from "../units";
import { PoseFields } from "./pose_fields";
import { fieldLine, QuantityField } from "../quantity_field";

type Kind = "sphere" | "box";
type Row = { element: HTMLElement; fields: PoseFields };
/** The size of a new obstacle, and its distance from the tool, as shares of the reach. */
const SIZE = 0.1;
const ASIDE = 0.5;

export class Obstacles {
  readonly panel = panel("obstacles", "Obstacles", false);
  private readonly avoid = h("input", { type: "checkbox", class: "switch", role: "switch", "data-avoid": "" });
  private readonly gap = this.distance("Least distance", "gap", 0.01);
  private readonly margin = this.distance("Distance below which pairs of bodies count", "margin", 0.3);
  private readonly kind = h("select", { class: "select", "aria-label": "Shape of a new obstacle" }, h("option", { value: "sphere" }, "sphere"), h("option", { value: "box" }, "box"));
  private readonly sizes = h("span", { class: "three" });
  private edges: QuantityField[] = [];
  private readonly listTitle = h("h3", { hidden: true }, "Poses; the name puts the handle on it");
  private readonly list = h("div", {});
  private readonly rows = new Map<string, Row>();
  private readonly addButton = h("button", { class: "button small", type: "button", onclick: () => this.add() }, "Add");
  private held: string | null = null;

  constructor(private readonly session: Session, private readonly hold: (name: string | null) => void) {
    this.avoid.addEventListener("change", () => this.sendAvoidance());
    this.kind.addEventListener("change", () => this.offerSizes());
    this.panel.body.append(
      h("label", { class: "row" }, this.avoid, h("span", {}, "Avoid collisions")),
      h("p", { class: "note" }, "The servo then solves least squares with inequalities, and the inverse below has no effect."),
      fieldLine("Keep", this.gap),
      fieldLine("Margin", this.margin),
      withUnit(h("h3", {}), "m", (unit) => `New obstacle, size [${unit}]`),
      h("div", { class: "new-obstacle" }, this.kind, this.sizes, this.addButton),
      this.listTitle,
      this.list,
    );
  }

  build(scene: Scene): void {
    const { avoidance, obstacles } = scene;
    this.avoid.checked = avoidance !== null;
    if (avoidance) {
      this.gap.show(avoidance.gap);
      this.margin.show(avoidance.margin);
    }
    if (!this.sizes.hasChildNodes()) this.offerSizes();
    this.panel.note([obstacles.length > 0 ? String(obstacles.length) : "", avoidance ? "avoided" : ""].filter(Boolean).join(", "));
    this.keep(obstacles);
    this.show(this.held);
  }

  /** Rows of obstacles that stay keep their nodes. */
  private keep(obstacles: Obstacle[]): void {
    const focused = this.list.contains(document.activeElement);
    for (const [name, { element }] of this.rows) {
      if (obstacles.some((other) => other.name === name)) continue;
      element.remove();
      this.rows.delete(name);
    }
    for (const { name, kind } of obstacles) {
      if (this.rows.has(name)) continue;
      const row = this.row(name, kind);
      this.rows.set(name, row);
      this.list.append(row.element);
    }
    this.listTitle.hidden = obstacles.length === 0;
    if (focused && !this.list.contains(document.activeElement)) this.addButton.focus();
  }

  private row(name: string, kind: string): Row {
    const fields = new PoseFields(
      { label: (part) => `${part} of ${name} in the world frame`, mark: (part) => ({ "data-obstacle": `${name} ${part}` }), orientation: kind !== "sphere" },
      (pose) => this.drag(name, pose),
    );
    const element = h(
      "div", { class: "obstacle", "data-row": name },
      h("span", { class: "row" },
        h("button", { class: "button small name", type: "button", title: `Drag ${name} in the view`, "aria-pressed": "false", onclick: () => this.hold(this.held === name ? null : name) }, name),
        h("span", { class: "note" }, kind.replaceAll("_", "-")),
        h("button", { class: "button small remove", type: "button", title: `Remove ${name}`, "aria-label": `Remove ${name}`, onclick: () => this.session.send({ type: "remove_obstacle", name }) }, "×")),
      fields.element,
    );
    return { element, fields };
  }

  /** Marks the obstacle at the handle. */
  show(held: string | null): void {
    this.held = held;
    for (const [name, { element }] of this.rows) element.querySelector(".name")?.setAttribute("aria-pressed", String(name === held));
  }

  place(state: State): void {
    if (!this.panel.isOpen()) return;
    this.session.scene?.obstacles.forEach(({ name }, i) => {
      const pose = state.obstacles[i];
      if (pose) this.rows.get(name)?.fields.show(pose);
    });
  }

  private distance(label: string, name: string, value: number): QuantityField {
    const field = new QuantityField("m", (unit) => `${label} (${unit})`, () => {
      if (this.avoid.checked) this.sendAvoidance();
    }, { min: 0, "data-avoidance": name });
    field.show(value);
    return field;
  }

  private sendAvoidance(): void {
    this.session.send({ type: "avoid_collisions", on: this.avoid.checked, gap: this.gap.value, margin: this.margin.value });
  }

  private offerSizes(): void {
    const size = Number((SIZE * (this.session.scene?.reach ?? 1)).toPrecision(1));
    const names = this.kind.value === "sphere" ? ["radius"] : ["x", "y", "z"];
    const value = this.kind.value === "sphere" ? size : 2 * size;
    this.edges = names.map((name) => new QuantityField("m", (unit) => (name === "radius" ? `Radius of the new sphere (${unit})` : `Edge of the new box along ${name} (${unit})`), () => undefined, { min: 0, "data-size": name }));
    for (const edge of this.edges) edge.show(value);
    fill(this.sizes, ...this.edges.map(({ element }) => element));
  }

  private add(): void {
    const { scene, state } = this.session;
    if (!scene || !state) return;
    const sizes = this.edges.map((edge) => edge.value);
    const kind = this.kind.value as Kind;
    if (sizes.some((size) => !Number.isFinite(size))) return;
    const shape: SimpleShape = kind === "sphere" ? { kind, radius: sizes[0] ?? 0 } : { kind, size: sizes as Vec3 };
    const taken = new Set(scene.obstacles.map(({ name }) => name));
    let number = 1;
    while (taken.has(`${kind} ${number}`)) number += 1;
    const [x, y, z] = state.tool.position;
    const position: Vec3 = [x, y - ASIDE * scene.reach, z];
    const name = `${kind} ${number}`;
    this.held = name;
    this.session.send({ type: "add_obstacle", name, shape, position, quaternion: [1, 0, 0, 0] });
  }

  /** An obstacle that was added and is not yet at the handle. */
  get added(): string | null {
    return this.held;
  }

  /** Sends the newest pose of an obstacle that is moved. */
  drag(name: string, pose: Pose): void {
    this.session.sendSoon(`obstacle ${name}`, { type: "move_obstacle", name, ...pose });
  }
}
