/** The units in which lengths, angles and orientations are shown and typed. */
import { h } from "../dom";
import { panel } from "../panels/panel";
import { choices, chooseUnit, chosenUnits, inUnits, type Choices } from "../units";
import { Choice } from "./choice";

const LABELS: [keyof Choices, string][] = [["length", "Length"], ["angle", "Angle"], ["orientation", "Orientation"]];

export class UnitControls {
  readonly panel = panel("units", "Units", false);

  constructor() {
    for (const [key, label] of LABELS) {
      const choice = new Choice(label, (value) => chooseUnit(key, value));
      this.panel.body.append(choice.element);
      inUnits(choice.element, () => choice.show(choices(key).map((name) => [name, name]), chosenUnits()[key]));
    }
    this.panel.body.append(h("p", { class: "note" }, "Of joints, poses, errors, distances and obstacles on this page. Ellipsoids, screws, reports and recordings are in SI."));
    inUnits(this.panel.element, () => this.panel.note(Object.values(chosenUnits()).join(", ")));
  }
}
