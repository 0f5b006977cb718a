/** All overlays: which are on, their drawings, and their words in the legend. */
import { Group } from "three";
import { h, Kept, swatch, text } from "../dom";
import { isEmpty, type OverlayInfo, type OverlayName, type Scene, type State } from "../protocol";
import type { Label, Labels } from "../scene/labels";
import { discard } from "../scene/shapes";
import { ellipsoid } from "./ellipsoid";
import { lostDirection } from "./lost";
import type { Context, Overlay } from "./overlay";
import { cylindroid } from "./surface";
import { jointAxes, principalScrews, reciprocalSystem } from "./systems";

const ALL: { [K in OverlayName]: Overlay<K> } = {
  "velocity-ellipsoid": ellipsoid("c-velocity"),
  "angular-velocity-ellipsoid": ellipsoid("c-angular"),
  "active-force-ellipsoid": ellipsoid("c-active-force"),
  "passive-force-ellipsoid": ellipsoid("c-passive-force"),
  "joint-axes": jointAxes,
  "principal-screws": principalScrews,
  "reciprocal-system": reciprocalSystem,
  cylindroid,
  "lost-direction": lostDirection,
};

export function overlayColour(name: OverlayName): string {
  return ALL[name].colour;
}

export class Overlays {
  readonly group = new Group();
  /** What is drawn. */
  readonly on = new Set<OverlayName>();
  /** What panels want to know of without a drawing. */
  private readonly wanted = new Set<OverlayName>();
  private readonly listeners = new Set<() => void>();
  private readonly kept: Kept;
  private words: HTMLElement[] = [];

  constructor(
    legend: HTMLElement,
    private readonly labels: Labels,
    private readonly changed: (names: OverlayName[]) => void,
  ) {
    this.kept = new Kept(legend);
  }

  onChange(listener: () => void): void {
    this.listeners.add(listener);
  }

  show(name: OverlayName, shown: boolean): void {
    if (shown) this.on.add(name);
    else this.on.delete(name);
    this.tell();
  }

  want(name: OverlayName, wanted: boolean): void {
    if (wanted) this.wanted.add(name);
    else this.wanted.delete(name);
    this.tell();
  }

  /** All that the server shall send. */
  names(): OverlayName[] {
    return [...new Set([...this.on, ...this.wanted])].filter((name) => name in ALL);
  }

  draw(scene: Scene, state: State, places: Pick<Context, "jointPlace" | "size">): void {
    for (const child of [...this.group.children]) discard(child);
    const labels: Label[] = [];
    const words: string[] = [];
    for (const info of scene.overlays) {
      if (!this.on.has(info.name)) continue;
      const group = new Group();
      group.renderOrder = 2;
      words.push(drawOne(info.name, group, {
        scene, state, ...places,
        line: places.size * 0.0075,
        label: (label) => labels.push(label),
      }));
      this.group.add(group);
    }
    this.labels.set("overlays", labels);
    this.write(scene.overlays.filter(({ name }) => this.on.has(name)), words);
  }

  /** The legend: a line for each overlay, whose words are set. */
  private write(shown: OverlayInfo[], words: string[]): void {
    this.kept.fill(shown, () => {
      this.words = shown.map(() => h("span", {}));
      return shown.map((info, i) => legendLine(info, this.words[i] ?? null));
    });
    this.words.forEach((element, i) => text(element, words[i] ? ` ${words[i]}` : ""));
  }

  private tell(): void {
    this.changed(this.names());
    for (const listener of this.listeners) listener();
  }
}

function drawOne<K extends OverlayName>(name: K, group: Group, context: Context): string {
  const overlay = ALL[name];
  const data = context.state.overlays[name];
  if (!data) return "loading";
  if (isEmpty(data)) return data.empty;
  const full = data as Parameters<typeof overlay.draw>[1];
  overlay.draw(group, full, context);
  group.traverse((part) => {
    part.renderOrder = 2;
  });
  return overlay.words(full, context);
}

function legendLine(info: OverlayInfo, words: HTMLElement | null): HTMLElement {
  return h("div", {}, swatch(overlayColour(info.name)), h("span", {}, h("b", {}, info.title), words));
}
