/** Bodies near each other: their pairs in a list, lines between their closest points in the view. */
import { Group, Mesh, SphereGeometry } from "three";
import { h, Kept } from "../dom";
import { fixed } from "../format";
import type { Near, Scene, State } from "../protocol";
import { drawn } from "../scene/palette";
import type { Labels } from "../scene/labels";
import { discard, rod, vector } from "../scene/shapes";
import type { Session } from "../session";
import { digitsOf, shown, unitOf } from "../units";
import { fieldLine, QuantityField } from "../quantity_field";
import { empty, grid, panel, type Grid } from "./panel";

const MARGIN = 0.2;
const BALL = new SphereGeometry(1, 12, 8);
BALL.userData["shared"] = true;

export class Distances {
  readonly panel = panel("distances", "Distances", false);
  readonly group = new Group();
  private readonly margin = new QuantityField("m", (unit) => `Only pairs closer than this (${unit})`, () => this.ask(), { min: 0, "data-margin": "" });
  private readonly list = h("div", {});
  private readonly kept = new Kept(this.list);
  private table: Grid | null = null;

  constructor(private readonly session: Session, private readonly labels: Labels, private readonly redraw: () => void) {
    this.panel.body.append(fieldLine("Within", this.margin), this.list);
    this.margin.show(MARGIN);
    this.panel.onToggle((open) => {
      this.ask();
      if (!open) this.clear();
      this.redraw();
    });
  }

  /** Asks for distances as long as the panel is open. */
  ask(): void {
    this.session.send({ type: "distances", margin: this.panel.isOpen() ? this.margin.value : null });
  }

  draw(scene: Scene, state: State, size: number): void {
    this.clear();
    const { distances } = state;
    if (!this.panel.isOpen() || !distances) return;
    const { near, more, pairs, shapes, margin } = distances;
    const stops = (one: Near): boolean => state.servo.pair !== null && state.servo.pair.join() === [one.a, one.b].join();
    this.panel.note(near.length > 0 ? `nearest ${length(near[0]?.distance ?? 0, 3)} ${unitOf("m")}` : "");
    for (const one of near) this.line(one, stops(one) || one.distance <= 0 ? "c-lost" : "c-distance", size);
    this.labels.set("distances", near.map((one) => ({
      text: `${length(one.distance, 3)} ${unitOf("m")}`,
      at: vector(one.point_a).lerp(vector(one.point_b), 0.5),
      colour: stops(one) || one.distance <= 0 ? "c-lost" : "c-distance",
    })));
    const noLinks = pairs === 0 && scene.obstacles.length === 0;
    this.kept.fill([near.map(({ a, b }) => [a, b]), more, pairs, shapes, margin, noLinks, unitOf("m")], () => {
      this.table = grid("Distances of bodies", ["", `distance [${unitOf("m")}]`], near.map(({ a, b }) => h("span", { title: `${a} and ${b}` }, a, h("br"), b)), "near");
      return [
        shapes === 0 && empty("No link of this model has a collision shape."),
        shapes > 0 && near.length === 0 && empty(`None of ${pairs} pairs is closer than ${length(margin, 3)} ${unitOf("m")}.`),
        near.length > 0 && this.table.element,
        near.length > 0 && h("p", { class: "note" }, `${near.length + more} of ${pairs} pairs${more > 0 ? `; the nearest ${near.length} are shown` : ""}`),
        shapes > 0 && noLinks && h("p", { class: "note" }, "Links that a joint connects are not watched."),
      ];
    });
    near.forEach((one, i) => {
      const row = this.table?.rows[i];
      if (!row) return;
      row.className = stops(one) ? "stops" : "";
      Object.assign(row.dataset, { near: `${one.a} ${one.b}`, value: one.distance });
      this.table?.set(i, [length(one.distance, 4)]);
    });
  }

  private clear(): void {
    for (const child of [...this.group.children]) discard(child);
    this.labels.set("distances", []);
    this.panel.note("");
  }

  private line(one: Near, colour: string, size: number): void {
    const [from, to] = [vector(one.point_a), vector(one.point_b)];
    const paint = drawn(colour);
    const line = rod(from, to, 0.0022 * size, paint);
    const ends = [from, to].map((end) => {
      const ball = new Mesh(BALL, paint);
      ball.position.copy(end);
      ball.scale.setScalar(0.006 * size);
      return ball;
    });
    for (const part of [line, ...ends]) {
      part.renderOrder = 2;
      this.group.add(part);
    }
  }
}

function length(metres: number, digits: number): string {
  return fixed(shown(metres, "m"), digitsOf("m", digits));
}
