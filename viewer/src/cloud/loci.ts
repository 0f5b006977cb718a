/** The loci of a map: curves in the view, by kind. */
import { Color, Group } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { h } from "../dom";
import { count } from "../format";
import { colour, onTheme } from "../theme";
import type { Locus } from "./table";

/** Colours of the style sheet; other kinds have the last. */
const KINDS = [["type II", "c-lost"], ["type I", "c-active-force"], ["passive", "c-reciprocal"], ["limit", "c-axes"]] as const;
const WIDTH = 2; // pixels

export class Loci {
  readonly group = new Group();
  private readonly paints = new Map<string, LineMaterial>();

  constructor() {
    for (const [, name] of KINDS) {
      const paint = new LineMaterial({ linewidth: WIDTH });
      const wear = (): void => void (paint.color = new Color(colour(name)));
      onTheme(wear);
      wear();
      this.paints.set(name, paint);
    }
  }

  show(loci: Locus[]): void {
    for (const child of [...this.group.children]) {
      (child as Line2).geometry.dispose();
      child.removeFromParent();
    }
    for (const { kind, places } of loci) {
      const paint = this.paints.get(colourOf(kind));
      if (!paint || places.length < 6) continue;
      const line = new Line2(new LineGeometry().setPositions(places), paint);
      line.frustumCulled = false;
      this.group.add(line);
    }
  }
}

/** A line for each kind, with how many curves it has. */
export function legendOf(loci: Locus[]): HTMLElement[] {
  const kinds = [...new Set(loci.map(({ kind }) => kind))];
  return kinds.map((kind) => {
    const swatch = h("span", { class: "swatch" });
    swatch.style.setProperty("--swatch", `var(--${colourOf(kind)})`);
    const words = `${kind}: ${count(loci.filter((locus) => locus.kind === kind).length, "curve")}`;
    return h("div", { class: "row" }, swatch, h("span", { class: "note" }, words));
  });
}

function colourOf(kind: string): string {
  return KINDS.find(([name]) => name === kind)?.[1] ?? "c-axes";
}
