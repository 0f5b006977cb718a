/** A labelled list of which one is chosen; its options are built anew only where they change. A long list has a filter. */
import { h, Kept, text } from "../dom";

export type Option = [value: string, words: string];

/** Longer lists are searched. */
const LONG = 12;

export class Choice {
  readonly element: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly filter: HTMLInputElement;
  private readonly found = h("span", { class: "note", role: "status" });
  private readonly kept: Kept;
  private options: Option[] = [];
  private value = "";

  constructor(label: string, private readonly chosen: (value: string) => void) {
    this.select = h("select", { class: "select", "aria-label": label, onchange: () => this.choose(this.select.value) });
    this.filter = h("input", {
      class: "field words", type: "search", "aria-label": `Search ${label.toLowerCase()}`, placeholder: "search", spellcheck: "false", autocomplete: "off",
      oninput: () => this.paint(), onkeydown: (event: KeyboardEvent) => this.key(event),
    });
    this.kept = new Kept(this.select);
    this.element = h("div", { class: "line choice" }, h("span", { class: "note" }, label), h("span", { class: "stack" }, this.filter, this.found, this.select));
  }

  show(options: Option[], value: string): void {
    [this.options, this.value] = [options, value];
    this.filter.hidden = options.length <= LONG;
    this.paint();
  }

  private choose(value: string): void {
    this.value = value;
    this.chosen(value);
  }

  /** Enter takes the first that is found, Escape shows all. */
  private key(event: KeyboardEvent): void {
    const first = this.filter.value && this.matching()[0];
    if (event.key === "Escape") this.filter.value = "";
    else if (event.key === "Enter" && first) {
      this.filter.value = "";
      this.choose(first[0]);
    } else return;
    event.preventDefault();
    event.stopPropagation();
    this.paint();
  }

  private matching(): Option[] {
    const wanted = this.filter.hidden ? "" : this.filter.value.trim().toLowerCase();
    return this.options.filter(([, words]) => words.toLowerCase().includes(wanted));
  }

  /** The chosen one stays in the list. */
  private paint(): void {
    const found = this.matching();
    const listed = this.options.filter((option) => found.includes(option) || option[0] === this.value);
    this.kept.fill(listed, () => listed.map(([name, words]) => h("option", { value: name }, words)));
    this.select.value = this.value;
    this.found.hidden = this.filter.hidden || !this.filter.value;
    text(this.found, `${found.length} of ${this.options.length}${found.length > 0 ? "; Enter chooses the first" : ""}`);
  }
}
