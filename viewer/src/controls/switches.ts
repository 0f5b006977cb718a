/** A switch for each overlay, with its unit and frame; and for the model's own shapes and those of collisions. */
import { h, Kept, swatch } from "../dom";
import { overlayColour, type Overlays } from "../overlays/overlays";
import { icon } from "../icons";
import { panel } from "../panels/panel";
import type { Scene } from "../protocol";

export class Switches {
  readonly panel = panel("show", "Show", true);
  private readonly boxes = new Map<string, HTMLInputElement>();
  private readonly shapes = h("input", { type: "checkbox", class: "switch", role: "switch", "data-overlay": "shapes" });
  private readonly collisions = h("input", { type: "checkbox", class: "switch", role: "switch", "data-collisions": "" });
  private readonly list = h("div", {});
  private readonly kept = new Kept(this.list);

  /** `save` gives the robot out as a file. */
  constructor(private readonly overlays: Overlays, show: { shapes: (shown: boolean) => void; collisions: (shown: boolean) => void }, save: () => void) {
    this.panel.body.append(
      this.list,
      h("div", { class: "row" }, h("button", { class: "button small", type: "button", onclick: save, title: "Save the robot as it is drawn as binary glTF" }, icon("save"), "glTF")),
    );
    this.shapes.checked = true;
    this.shapes.addEventListener("change", () => show.shapes(this.shapes.checked));
    this.collisions.addEventListener("change", () => show.collisions(this.collisions.checked));
    overlays.onChange(() => {
      for (const [name, box] of this.boxes) box.checked = [...overlays.on].some((on) => on === name);
    });
  }

  build(scene: Scene, hasShapes: boolean): void {
    const hasCollisions = scene.links.some((link) => link.collisions.length > 0);
    this.kept.fill([scene.overlays, hasShapes, hasCollisions], () => {
      this.boxes.clear();
      const rows = scene.overlays.map((info) => {
        const box = h("input", { type: "checkbox", class: "switch", role: "switch", "data-overlay": info.name });
        box.checked = this.overlays.on.has(info.name);
        box.addEventListener("change", () => this.overlays.show(info.name, box.checked));
        this.boxes.set(info.name, box);
        return row(box, overlayColour(info.name), info.title, `${info.unit}; ${info.frame}`);
      });
      return [
        ...rows,
        rows.length === 0 && h("p", { class: "empty" }, "No overlays are available for this model."),
        hasShapes && row(this.shapes, "body-2", "Shapes of the model", "m; off: rods and joints"),
        hasCollisions && row(this.collisions, "c-collision", "Collision shapes", "m"),
      ];
    });
  }
}

function row(box: HTMLInputElement, colour: string, title: string, note: string): HTMLElement {
  return h("label", { class: "overlay" }, box, swatch(colour), h("span", { class: "what" }, title), h("span", { class: "note" }, note));
}
