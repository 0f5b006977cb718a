/** Makes elements: `h("button", { class: "x", onclick: f }, "text", child)`. */

export type Child = Node | string | number | null | undefined | false;
type Props = Record<string, unknown>;

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) {
      element.addEventListener(key.slice(2), value as EventListener);
    } else if (key === "class") {
      element.className = String(value);
    } else if (value === true) {
      element.setAttribute(key, "");
    } else {
      element.setAttribute(key, String(value));
    }
  }
  append(element, children);
  return element;
}

/** A patch of a colour of the style sheet, by its name there without the dashes. */
export function swatch(colour: string): HTMLElement {
  const patch = h("span", { class: "swatch" });
  patch.style.setProperty("--swatch", `var(--${colour})`);
  return patch;
}

const SVG = "http://www.w3.org/2000/svg";

/** The same for SVG. */
export function s(tag: string, props: Props = {}, ...children: Child[]): SVGElement {
  const element = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(props)) {
    if (value !== undefined && value !== null && value !== false) {
      element.setAttribute(key, String(value));
    }
  }
  append(element, children);
  return element;
}

function append(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(typeof child === "number" ? String(child) : child);
  }
}

/** Puts these in place of what is there. */
export function fill(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Fills an element again only where what its nodes are made from has changed: nodes keep focus and what is typed. */
export class Kept {
  private from = "";

  constructor(private readonly element: Element) {}

  /** True where it was filled. */
  fill(from: unknown, make: () => Child[]): boolean {
    const now = JSON.stringify(from);
    if (now === this.from) return false;
    this.from = now;
    fill(this.element, ...make());
    return true;
  }
}

/** Sets text only where it changed: browsers lay out again otherwise. */
export function text(element: Element, value: string): void {
  if (element.textContent !== value) element.textContent = value;
}
