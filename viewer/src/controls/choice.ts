/** A labelled list of which one is chosen; its options are built anew only where they change. */
import { h, Kept } from "../dom";

export type Option = [value: string, words: string];

export class Choice {
  readonly element: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly kept: Kept;

  constructor(label: string, chosen: (value: string) => void) {
    this.select = h("select", { class: "select", "aria-label": label, onchange: () => chosen(this.select.value) });
    this.kept = new Kept(this.select);
    this.element = h("label", { class: "line" }, h("span", { class: "note" }, label), this.select);
  }

  show(options: Option[], value: string): void {
    this.kept.fill(options, () => options.map(([name, words]) => h("option", { value: name }, words)));
    this.select.value = value;
  }
}
