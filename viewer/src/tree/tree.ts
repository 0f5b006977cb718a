/** The tree of links, joints and frames: searched, folded and chosen by keys or the pointer. */
import { fill, h, text } from "../dom";
import { icon, type Icon } from "../icons";
import type { Item, Kind } from "./items";

const ICONS: Record<Kind, Icon> = { link: "link", joint: "joint", frame: "frame", loop: "closing" };
/** Deeper items are indented no further. */
const DEEPEST = 14;

type Told = { select: (key: string) => void; hover: (key: string | null) => void };
type Row = { item: Item; element: HTMLElement; tool: HTMLElement };

export class Tree {
  readonly element: HTMLElement;
  private readonly tree = h("div", { class: "tree", role: "tree", tabindex: 0, "aria-label": "Links, joints and frames" });
  private readonly filter: HTMLInputElement;
  private readonly found = h("span", { class: "note", role: "status" });
  private rows: Row[] = [];
  private readonly folded = new Set<string>();
  /** The item that the keys are on. */
  private active: string | null = null;

  constructor(private readonly tell: Told) {
    this.filter = h("input", {
      class: "field words wide", type: "search", "aria-label": "Search links, joints and frames", placeholder: "search", spellcheck: "false", autocomplete: "off",
      oninput: () => this.paint(), onkeydown: (event: KeyboardEvent) => this.searchKey(event),
    });
    this.element = h("div", { class: "stack" }, this.filter, this.found, this.tree);
    this.tree.addEventListener("keydown", (event) => this.key(event));
    this.tree.addEventListener("focus", () => {
      // A press of the pointer is on an item of its own: nothing scrolls away under it.
      if (this.tree.matches(":focus-visible")) this.go(this.active ?? this.shown()[0]?.item.key ?? null);
    });
    this.tree.addEventListener("blur", () => {
      this.tell.hover(null);
      this.paint();
    });
    this.tree.addEventListener("pointerleave", () => this.tell.hover(null));
  }

  build(items: Item[]): void {
    this.rows = items.map((item, i) => this.row(item, i));
    fill(this.tree, ...this.rows.map(({ element }) => element));
    if (!items.some(({ key }) => key === this.active)) this.active = null;
    this.paint();
  }

  /** Shows what is selected, unfolded and in sight, and which frame is the tool. */
  show(selected: Item | null, tool: string, reveal: boolean): void {
    for (const { item, element, tool: badge } of this.rows) {
      element.setAttribute("aria-selected", String(item.key === selected?.key));
      const isTool = (item.kind === "frame" || item.kind === "link") && item.name === tool;
      if (badge.hidden === isTool) badge.hidden = !isTool;
    }
    if (!selected || !reveal) return;
    for (let at = selected.parent; at; at = at.parent) this.folded.delete(at.key);
    // Not under the hands of who is searching.
    if (!this.matches(selected) && document.activeElement !== this.filter) this.filter.value = "";
    this.active = selected.key;
    this.paint();
    this.rows.find(({ item }) => item.key === selected.key)?.element.scrollIntoView({ block: "nearest" });
  }

  private row(item: Item, i: number): Row {
    const tool = h("span", { class: "badge", hidden: true }, "tool");
    const fold = h("span", { class: "fold", "aria-hidden": "true" });
    const element = h(
      "div", { class: "item", role: "treeitem", id: `item-${i}`, "data-item": item.key, "aria-level": item.level, title: item.words },
      fold, icon(ICONS[item.kind]), h("span", { class: "name" }, item.name), " ", tool,
    );
    element.style.setProperty("--level", String(Math.min(item.level - 1, DEEPEST)));
    element.addEventListener("pointermove", () => this.tell.hover(item.key));
    element.addEventListener("click", (event) => {
      if (fold.contains(event.target as Node)) this.fold(item, !this.folded.has(item.key));
      else {
        this.active = item.key;
        this.tell.hover(item.key);
        this.tell.select(item.key);
      }
      this.paint();
    });
    return { item, element, tool };
  }

  private get wanted(): string {
    return this.filter.value.trim().toLowerCase();
  }

  private matches(item: Item): boolean {
    return item.name.toLowerCase().includes(this.wanted);
  }

  /** Rows that are found, with those above them; without a search, those that are not folded away. */
  private shown(): Row[] {
    if (this.wanted) {
      const kept = new Set<Item>();
      for (const { item } of this.rows) {
        if (!this.matches(item)) continue;
        for (let at: Item | null = item; at && !kept.has(at); at = at.parent) kept.add(at);
      }
      return this.rows.filter(({ item }) => kept.has(item));
    }
    const hidden = new Set<Item>();
    return this.rows.filter(({ item }) => {
      const isHidden = item.parent !== null && (hidden.has(item.parent) || this.folded.has(item.parent.key));
      if (isHidden) hidden.add(item);
      return !isHidden;
    });
  }

  private paint(): void {
    const shown = new Set(this.shown());
    for (const row of this.rows) {
      const { item, element } = row;
      if (element.hidden === shown.has(row)) element.hidden = !shown.has(row);
      element.classList.toggle("active", item.key === this.active && this.tree === document.activeElement);
      element.classList.toggle("found", this.wanted !== "" && this.matches(item));
      if (item.children.length > 0) element.setAttribute("aria-expanded", String(this.wanted !== "" || !this.folded.has(item.key)));
      else element.removeAttribute("aria-expanded");
    }
    const active = this.rows.find(({ item }) => item.key === this.active);
    if (active && shown.has(active)) this.tree.setAttribute("aria-activedescendant", active.element.id);
    else this.tree.removeAttribute("aria-activedescendant");
    this.found.hidden = this.wanted === "";
    const count = this.rows.filter(({ item }) => this.matches(item)).length;
    text(this.found, this.wanted === "" ? "" : `${count} of ${this.rows.length}${count > 0 ? "; Enter selects the first" : ""}`);
  }

  private fold(item: Item, folded: boolean): void {
    if (folded && item.children.length > 0) this.folded.add(item.key);
    else this.folded.delete(item.key);
    this.paint();
  }

  /** Moves the keys to an item, which is marked in the view. */
  private go(key: string | null): void {
    this.active = key;
    this.tell.hover(key);
    this.paint();
    this.rows.find(({ item }) => item.key === key)?.element.scrollIntoView({ block: "nearest" });
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const rows = this.shown();
    const at = rows.findIndex(({ item }) => item.key === this.active);
    const item = rows[at]?.item;
    const isOpen = item !== undefined && item.children.length > 0 && (this.wanted !== "" || !this.folded.has(item.key));
    const to = (i: number): void => this.go(rows[Math.min(Math.max(i, 0), rows.length - 1)]?.item.key ?? null);
    if (event.key === "ArrowDown") to(at + 1);
    else if (event.key === "ArrowUp") to(at - 1);
    else if (event.key === "Home") to(0);
    else if (event.key === "End") to(rows.length - 1);
    else if (event.key === "ArrowRight" && item && !isOpen) this.fold(item, false);
    else if (event.key === "ArrowRight" && isOpen) to(at + 1);
    else if (event.key === "ArrowLeft" && isOpen && this.wanted === "") this.fold(item, true);
    else if (event.key === "ArrowLeft" && item?.parent) this.go(item.parent.key);
    else if ((event.key === "Enter" || event.key === " ") && item) this.tell.select(item.key);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Enter selects the first that is found, Escape shows all. */
  private searchKey(event: KeyboardEvent): void {
    const first = this.wanted === "" ? undefined : this.rows.find(({ item }) => this.matches(item));
    if (event.key === "Escape" && this.filter.value) this.filter.value = "";
    else if (event.key === "Enter" && first) {
      this.filter.value = "";
      this.tell.select(first.item.key);
    } else return;
    event.preventDefault();
    event.stopPropagation();
    this.paint();
  }
}
