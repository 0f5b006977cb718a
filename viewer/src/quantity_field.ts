/** A number field of a length, an angle or a plain number: shows the units of display, gives SI. */
import { h } from "./dom";
import { plain } from "./format";
import { digitsOf, inUnits, shown, typed, unitOf, withUnit, type Quantity } from "./units";

const DIGITS = 4;

export class QuantityField {
  readonly element: HTMLInputElement;
  private si = NaN;

  /** `label` of the unit of display; `changed` after typing a finite number, in SI. */
  constructor(readonly quantity: Quantity, label: (unit: string) => string, changed: (value: number) => void, props: Record<string, unknown> = {}) {
    this.element = h("input", { class: "field", type: "number", step: "any", ...props, onchange: () => {
      const value = this.element.valueAsNumber;
      if (!Number.isFinite(value)) return;
      this.si = typed(value, quantity);
      changed(this.si);
    } });
    inUnits(this.element, () => {
      this.element.setAttribute("aria-label", label(unitOf(quantity)));
      this.write();
    });
  }

  /** What is shown or was typed last, in SI. */
  get value(): number {
    return this.si;
  }

  /** Shows a value, unless one is typing. */
  show(value: number): void {
    if (document.activeElement === this.element) return;
    this.si = value;
    this.write();
  }

  private write(): void {
    const { si, quantity } = this;
    const words = Number.isFinite(si) ? plain(shown(si, quantity), digitsOf(quantity, DIGITS)) : "";
    if (this.element.value !== words) this.element.value = words;
  }
}

/** A row: words with the unit, then the field. */
export function fieldLine(words: string, field: QuantityField): HTMLElement {
  return h("div", { class: "line" }, withUnit(h("span", { class: "note" }), field.quantity, (unit) => `${words} [${unit}]`), field.element);
}
