/** A panel: a heading that folds, a note in it, a body. */
import { h, text } from "../dom";

export type Panel = {
  element: HTMLDetailsElement;
  body: HTMLElement;
  note: (words: string) => void;
  isOpen: () => boolean;
  onToggle: (work: (open: boolean) => void) => void;
};

const KEY = "cylindroid-panel-";

export function panel(name: string, title: string, open: boolean): Panel {
  const words = h("span", { class: "note" });
  const body = h("div", { class: "body" });
  const element = h("details", { class: "panel", "data-panel": name }, h("summary", {}, title, words), body);
  element.open = remembered(name) ?? open;
  element.addEventListener("toggle", () => {
    try {
      localStorage.setItem(KEY + name, String(element.open));
    } catch {
      // only a convenience
    }
  });
  return {
    element,
    body,
    note: (value) => text(words, value),
    isOpen: () => element.open,
    onToggle: (work) => element.addEventListener("toggle", () => work(element.open)),
  };
}

function remembered(name: string): boolean | null {
  try {
    const value = localStorage.getItem(KEY + name);
    return value === null ? null : value === "true";
  } catch {
    return null;
  }
}

/** Pairs of a name and a value. */
export function pairs(...entries: [string, string | Node][]): HTMLElement {
  return h("dl", { class: "pairs" }, ...entries.flatMap(([name, value]) => [h("dt", {}, name), h("dd", { class: typeof value === "string" ? "number" : "" }, value)]));
}

/** A table of numbers with a head; the first cell of each row names it. */
export function numbers(caption: string, head: string[], rows: (string | Node)[][]): HTMLElement {
  return h(
    "div", { class: "scroll" },
    h(
      "table", { class: "numbers" },
      h("caption", { class: "hidden-label" }, caption),
      h("thead", {}, h("tr", {}, ...head.map((name, i) => (i === 0 ? h("td", {}) : h("th", { scope: "col" }, name))))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((cell, i) => (i === 0 ? h("th", { scope: "row" }, cell) : h("td", {}, cell)))))),
    ),
  );
}

export function empty(words: string): HTMLElement {
  return h("p", { class: "empty" }, words);
}
