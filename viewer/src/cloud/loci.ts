/** The loci of a map: curves in the view, by kind. */
import { Group, type Plane } from "three";
import { h, swatch } from "../dom";
import { count } from "../format";
import { clearCurves, curve, curvePaint } from "../scene/curve";
import type { Locus } from "./table";

/** Colours of the style sheet; other kinds have the last. */
const KINDS = [["type II", "c-lost"], ["type I", "c-active-force"], ["passive", "c-reciprocal"], ["limit", "c-axes"]] as const;
const WIDTH = 2; // pixels

export class Loci {
  readonly group = new Group();
  private readonly paints = new Map(KINDS.map(([, colour]) => [colour as string, curvePaint(colour, WIDTH)]));

  show(loci: Locus[]): void {
    clearCurves(this.group);
    for (const { kind, places } of loci) {
      const paint = this.paints.get(colourOf(kind));
      if (paint) this.group.add(curve(places, paint));
    }
  }

  /** Leaves out what lies on the far side of these planes. */
  cut(planes: Plane[]): void {
    for (const paint of this.paints.values()) paint.clippingPlanes = planes;
  }
}

/** A line for each kind, with how many curves it has. */
export function legendOf(loci: Locus[]): HTMLElement[] {
  const kinds = [...new Set(loci.map(({ kind }) => kind))];
  return kinds.map((kind) => {
    const curves = loci.filter((locus) => locus.kind === kind).length;
    return h("div", { class: "row" }, swatch(colourOf(kind)), h("span", { class: "note" }, `${kind}: ${count(curves, "curve")}`));
  });
}

function colourOf(kind: string): string {
  return KINDS.find(([name]) => name === kind)?.[1] ?? "c-axes";
}
