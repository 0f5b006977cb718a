/** Short words in the view: elements over the picture, moved with the camera; those that would overlap wait. */
import { Vector3, type Camera } from "three";
import { h, text } from "../dom";

export type Label = { text: string; at: Vector3; colour: string };

export class Labels {
  private readonly layer = h("div", { class: "labels", "aria-hidden": "true" });
  private readonly elements: HTMLElement[] = [];
  private readonly all = new Map<string, Label[]>();

  constructor(private readonly stage: HTMLElement) {
    stage.append(this.layer);
  }

  /** The labels of one source, in place of its last ones. */
  set(source: string, labels: Label[]): void {
    this.all.set(source, labels);
  }

  /** Puts every label where its point is seen now. */
  place(camera: Camera): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const taken: { x: number; y: number; w: number }[] = [];
    const labels = [...this.all.values()].flat();
    labels.forEach((label, i) => {
      const element = this.element(i);
      const seen = label.at.clone().project(camera);
      const [x, y] = [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height];
      const w = label.text.length * 7 + 10;
      const free = taken.every((other) => Math.abs(other.y - y) > 17 || x > other.x + other.w || x + w < other.x);
      const inside = seen.z < 1 && x > 4 && y > 48 && x + w < width && y < height - 24;
      element.hidden = !(free && inside);
      if (element.hidden) return;
      taken.push({ x, y, w });
      text(element, label.text);
      element.style.transform = `translate(${Math.round(x + 7)}px, ${Math.round(y - 9)}px)`;
      element.style.setProperty("--swatch", `var(--${label.colour})`);
    });
    this.elements.slice(labels.length).forEach((element) => {
      element.hidden = true;
    });
  }

  private element(index: number): HTMLElement {
    const known = this.elements[index];
    if (known) return known;
    const made = h("span", { class: "label" });
    this.layer.append(made);
    this.elements.push(made);
    return made;
  }
}
