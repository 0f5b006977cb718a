/** The map of a sweep: its points in the view, what colours them, a cut, and the robot at the point that is clicked or named. */
import { Choice } from "../controls/choice";
import { fill, h, text } from "../dom";
import { count, fixed, short } from "../format";
import { panel } from "../panels/panel";
import type { Scene } from "../protocol";
import type { Picking } from "../scene/picking";
import type { Stage } from "../scene/stage";
import type { Session } from "../session";
import { Cloud, type Axis } from "./cloud";
import { rangeOf } from "./colours";
import { legendOf, Loci } from "./loci";
import { readTable, type Table } from "./table";

/** Columns that number rows. */
const NUMBERS = ["index"];
const PLACES = ["x", "y", "z", "qw", "qx", "qy", "qz"];
const AXES: Axis[] = ["x", "y", "z"];
const HINT = "A click on a point, or its number, moves the robot there.";
const SIZE = { least: 1, most: 12, first: 3 };

export class MapPanel {
  readonly panel = panel("map", "Map", true);
  readonly cloud: Cloud;
  readonly loci = new Loci();
  private readonly colour = new Choice("Colour", (name) => this.paint(name));
  private readonly axis = new Choice("Cut", (axis) => this.cut(AXES.find((one) => one === axis) ?? null));
  private readonly low = h("span", { class: "number" });
  private readonly high = h("span", { class: "number" });
  private readonly clicked = h("p", { class: "note", role: "status" }, HINT);
  /** Says where the points are not. */
  private readonly relative = h("p", { class: "note" });
  private readonly number = h("input", { class: "field", type: "number", min: 0, step: 1, "aria-label": "Number of a point" });
  private readonly size = h("input", { type: "range", min: SIZE.least, max: SIZE.most, step: 0.5, value: SIZE.first, "aria-label": "Size of points [pixels]" });
  private readonly place = h("input", { type: "range", step: "any", "aria-label": "Place of the cut [m]" });
  private readonly placeWords = h("span", { class: "note" });
  private readonly legend = h("div", {});
  private table: Table | null = null;
  private cutAxis: Axis | null = null;
  /** The column that colours. */
  private painted = "";

  constructor(private readonly session: Session, stage: Stage, private readonly say: (words: string, bad?: boolean) => void, picking: Picking) {
    this.cloud = new Cloud(stage, (row) => this.pick(row), picking);
    this.cloud.group.add(this.loci.group);
    this.size.addEventListener("input", () => {
      fillSlider(this.size);
      this.cloud.resize(this.size.valueAsNumber);
    });
    fillSlider(this.size);
    this.place.addEventListener("input", () => this.move());
    this.number.addEventListener("change", () => this.pickNumber());
    this.panel.body.append(
      this.relative,
      this.colour.element,
      h("div", { class: "ramp-line" }, this.low, h("span", { class: "ramp" }), this.high),
      h("label", { class: "line" }, h("span", { class: "note" }, "Points"), this.size),
      this.legend,
      this.axis.element,
      h("label", { class: "line" }, this.placeWords, this.place),
      h("div", { class: "row" },
        h("label", { class: "line" }, h("span", { class: "note" }, "Point"), this.number),
        h("button", { class: "button small", type: "button", onclick: () => this.pickExtreme(-1) }, "Smallest"),
        h("button", { class: "button small", type: "button", onclick: () => this.pickExtreme(1) }, "Largest"),
      ),
      this.clicked,
      h("div", { class: "row" }, h("button", { class: "button small", type: "button", onclick: () => this.show(null) }, "Remove")),
    );
    this.panel.element.hidden = true;
  }

  /** Shows the map of a file; false where it is none. */
  async open(file: File): Promise<boolean> {
    try {
      const table = await readTable(file);
      if (table) this.show(table);
      return table !== null;
    } catch (error) {
      this.say(error instanceof Error ? error.message : String(error), true);
      return true;
    }
  }

  private show(table: Table | null): void {
    this.table = table;
    this.panel.element.hidden = !table;
    this.loci.show(table?.loci ?? []);
    fill(this.legend, ...legendOf(table?.loci ?? []));
    this.cloud.show(table, this.size.valueAsNumber);
    if (!table) return;
    this.panel.note(`${table.name}, ${count(table.rows, "point")}`);
    const base = table.relativeTo;
    this.relative.hidden = base === null;
    text(this.relative, base === null ? "" : `Places are relative to ${base}, not to the world: they are drawn as if ${base} were at the world's origin.`);
    const joints = new Set(this.session.scene?.coordinates.map(({ name }) => name));
    const names = [...table.columns.keys()].filter((name) => !NUMBERS.includes(name));
    const first = names.find((name) => !joints.has(name) && !PLACES.includes(name)) ?? "z";
    this.colour.show(names.map((name) => [name, name]), first);
    this.axis.show([["", "none"], ...AXES.map((axis): [string, string] => [axis, `beyond ${axis}`])], "");
    this.paint(first);
    this.cut(null);
    this.number.value = "";
    text(this.clicked, HINT);
  }

  private paint(name: string): void {
    this.painted = name;
    const values = this.table?.columns.get(name);
    if (!values) return;
    const range = rangeOf(values);
    this.cloud.paint(values, range);
    text(this.low, short(range[0]));
    text(this.high, short(range[1]));
  }

  private cut(axis: Axis | null): void {
    this.cutAxis = axis;
    this.place.disabled = axis === null;
    if (axis) {
      const { min, max } = this.cloud.box();
      [this.place.min, this.place.max] = [String(min[axis]), String(max[axis])];
      this.place.valueAsNumber = (min[axis] + max[axis]) / 2;
    }
    this.move();
  }

  private move(): void {
    const at = this.place.valueAsNumber;
    fillSlider(this.place);
    text(this.placeWords, this.cutAxis ? `Cut at ${fixed(at, 2)} m` : "Cut at");
    this.cloud.cut(this.cutAxis, at);
    this.loci.cut(this.cloud.planes());
  }

  /** Moves the robot to the configuration of a row; coordinates that it has not stay. */
  private pick(row: number): void {
    const { table } = this;
    const { scene, state } = this.session;
    if (!table || !scene || !state) return;
    const columns = scene.coordinates.map(({ name }) => table.columns.get(name));
    if (columns.every((column) => !column)) {
      this.say(`${table.name} has no column of a joint of ${scene.name}; the robot stays.`, true);
      return;
    }
    const q = state.q.map((value, i) => columns[i]?.[row] ?? value);
    const number = table.columns.get("index")?.[row] ?? row;
    this.number.value = String(number);
    text(this.clicked, `Point ${number}: ${this.words(table, row, scene)}`);
    this.session.send({ type: "configuration", q });
  }

  /** The point whose number was entered. */
  private pickNumber(): void {
    const { table } = this;
    const number = this.number.valueAsNumber;
    if (!table || Number.isNaN(number)) return;
    const row = table.columns.get("index")?.indexOf(number) ?? number;
    if (Number.isInteger(row) && row >= 0 && row < table.rows) this.pick(row);
    else this.say(`${table.name} has no point ${number}.`, true);
  }

  /** The point, of those that are not cut away, where what colours is smallest (-1) or largest (1). */
  private pickExtreme(sign: -1 | 1): void {
    const values = this.table?.columns.get(this.painted);
    let best = -1;
    values?.forEach((value, row) => {
      if (Number.isFinite(value) && this.cloud.shows(row) && (best < 0 || sign * value > sign * (values[best] ?? NaN))) best = row;
    });
    if (best >= 0) this.pick(best);
    else this.say(`${this.painted} has no finite value.`, true);
  }

  private words(table: Table, row: number, scene: Scene): string {
    const joints = new Set(scene.coordinates.map(({ name }) => name));
    const shown = [...table.columns].filter(([name]) => !joints.has(name) && !NUMBERS.includes(name) && !PLACES.slice(3).includes(name));
    return shown.slice(0, 8).map(([name, values]) => `${name} ${short(values[row], 4)}`).join(", ");
  }
}

/** The part of a slider before its thumb is coloured. */
function fillSlider(slider: HTMLInputElement): void {
  const [low, high] = [Number(slider.min), Number(slider.max)];
  slider.style.setProperty("--filled", `${high > low ? ((100 * (slider.valueAsNumber - low)) / (high - low)).toFixed(1) : 0}%`);
}
