/** The item of the model that is selected, and the one that the pointer or the focus is on. */
import type { Scene } from "../protocol";
import { items, type Item } from "./items";

export class Selection {
  all: Item[] = [];
  private from = "";
  private chosen: string | null = null;
  private over: string | null = null;
  private readonly told = new Set<(byPicking: boolean) => void>();

  /** Called when another item is selected or under the pointer; with true if it was picked in the view. */
  onChange(work: (byPicking: boolean) => void): void {
    this.told.add(work);
  }

  /** For the items of a scene; true where they are others. */
  build(scene: Scene): boolean {
    const from = JSON.stringify([scene.frames, scene.joints, scene.loops, scene.links.map(({ name }) => name)]);
    if (from === this.from) return false;
    this.from = from;
    this.all = items(scene);
    // What is still there by its name stays selected.
    if (!this.selected) this.chosen = null;
    this.over = null;
    return true;
  }

  get selected(): Item | null {
    return this.all.find(({ key }) => key === this.chosen) ?? null;
  }

  /** What is marked in the view. */
  get marked(): Item | null {
    return this.all.find(({ key }) => key === this.over) ?? this.selected;
  }

  select(key: string | null, byPicking = false): void {
    if (key === this.chosen && !byPicking) return;
    this.chosen = key;
    this.tell(byPicking);
  }

  hover(key: string | null): void {
    if (key === this.over) return;
    this.over = key;
    this.tell(false);
  }

  private tell(byPicking: boolean): void {
    for (const work of this.told) work(byPicking);
  }
}
