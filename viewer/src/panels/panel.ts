/** A panel: a heading that folds, a note in it, a body. */
import { h, text, type Child } from "../dom";

export type Panel = {
  element: HTMLDetailsElement;
  body: HTMLElement;
  note: (words: string) => void;
  /** While a recording is shown: the values are not of it, but of the robot as it is. */
  stale: (stale: boolean) => void;
  isOpen: () => boolean;
  onToggle: (work: (open: boolean) => void) => void;
};

const KEY = "cylindroid-panel-";

export function panel(name: string, title: string, open: boolean): Panel {
  const words = h("span", { class: "note" });
  const body = h("div", { class: "body" });
  const warning = h("p", { class: "doubt", hidden: true }, "Of the robot as it is, not of the recording");
  const element = h("details", { class: "panel", "data-panel": name }, h("summary", {}, h("h2", {}, title), words), warning, body);
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
    stale: (stale) => {
      if (warning.hidden === stale) warning.hidden = !stale;
    },
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
export function pairs(...entries: [string, string][]): HTMLElement {
  const made = facts(entries.map(([name]) => name));
  entries.forEach(([, value], i) => made.set(i, value));
  return made.element;
}

/** Named values that are set later. */
export function facts(names: string[]): { element: HTMLElement; set: (i: number, value: string) => void } {
  const values = names.map(() => h("dd", { class: "number" }));
  const element = h("dl", { class: "pairs" }, ...names.flatMap((name, i) => [h("dt", {}, name), values[i]]));
  return { element, set: (i, value) => void (values[i] && text(values[i], value)) };
}

/** A table of numbers with a head; the first cell of each row names it. */
export function numbers(caption: string, head: string[], rows: string[][]): HTMLElement {
  const made = grid(caption, head, rows.map((row) => row[0] ?? ""));
  rows.forEach((row, i) => made.set(i, row.slice(1)));
  return made.element;
}

/** A table of numbers whose rows are set later; `head` begins with the column of the names. */
export function grid(caption: string, head: string[], names: Child[], style = ""): Grid {
  const cells = names.map(() => head.slice(1).map(() => h("td", {})));
  const rows = names.map((name, i) => h("tr", {}, h("th", { scope: "row" }, name), ...(cells[i] ?? [])));
  const element = h(
    "div", { class: "scroll" },
    h(
      "table", { class: `numbers ${style}`.trim() },
      h("caption", { class: "hidden-label" }, caption),
      h("thead", {}, h("tr", {}, ...head.map((name, i) => (i === 0 ? h("td", {}) : h("th", { scope: "col" }, name))))),
      h("tbody", {}, ...rows),
    ),
  );
  const set = (i: number, values: string[]): void => cells[i]?.forEach((cell, k) => text(cell, values[k] ?? ""));
  return { element, rows, set };
}

export type Grid = { element: HTMLElement; rows: HTMLElement[]; set: (row: number, values: string[]) => void };

export function empty(words: string): HTMLElement {
  return h("p", { class: "empty" }, words);
}
