/** What can be plotted over time. */
import type { Quantity } from "../units";
import type { Column } from "./columns";
import type { Recording } from "./recording";
import type { Model } from "./together";

/** What a model has to plot; `moves`: of one coordinate, whose motion this is. */
type Own = { label: string; column: Column; quantity: Quantity; isThreshold?: boolean; moves?: Column };
/** `model`: its number among those of the recording; `rank`: its place among the lines of this model. */
export type Line = Own & { model: number; rank: number };
export type Kind = {
  name: string; title: string;
  /** After the unit of a line. */
  per: "" | "/s";
  logarithmic: boolean;
  lines: (recording: Recording) => Own[];
  /** Said beside the unit. */
  remark?: (recording: Recording) => string;
  /** Said where no sample has a value. */
  none: string;
};

/** Of more coordinates, those that move most are plotted. */
const MOST_LINES = 12;

export const KINDS: Kind[] = [
  { name: "joints", title: "Joints", per: "", logarithmic: false, lines: (r) => ofCoordinates(r, r.columns.q), none: "The model has no coordinate." },
  {
    name: "rates", title: "Joint velocities", per: "/s", logarithmic: false, none: "No two samples are at different times.",
    lines: (r) => ofCoordinates(r, r.columns.rates), remark: (r) => (r.columns.areDifferences ? "differences of positions" : ""),
  },
  {
    name: "errors", title: "Error", per: "", logarithmic: false, none: "The file contains no errors.",
    lines: ({ columns }) => lines(["distance", "angle"], columns.errors, ["m", "rad"]),
  },
  {
    name: "singular", title: "Singular values", per: "", logarithmic: true, none: "The servo is not available: there are no singular values.",
    lines: ({ columns }) => [
      ...lines(columns.singular.map((_, i) => `σ${i + 1}`), columns.singular, []),
      { label: "threshold", column: columns.threshold, quantity: "", isThreshold: true },
    ],
  },
  { name: "margins", title: "Distances to limits", per: "", logarithmic: false, lines: (r) => ofCoordinates(r, r.columns.margins), none: "No coordinate has a limit." },
];

/** The lines of all models, those of models beside the first under their names; `of`: as many there would be. */
export function linesOf({ lines }: Kind, models: Model[]): { kept: Line[]; of: number } {
  const all = models.map(({ name, recording }, model) => lines(recording).map((line) => ({ ...line, model, label: model === 0 ? line.label : `${name}.${line.label}` })));
  const moving = all.flat().flatMap((line) => (line.moves ? [{ line, range: range(line.moves) }] : []));
  const least = moving.sort((a, b) => b.range - a.range).slice(MOST_LINES).map(({ line }) => line);
  const kept = all.flatMap((own) => own.filter((line) => !least.includes(line)).map((line, rank) => ({ ...line, rank })));
  return { kept, of: kept.length + least.length };
}

function lines(labels: string[], columns: Column[], quantities: Quantity[]): Own[] {
  return columns.map((column, i) => ({ label: labels[i] ?? "", column, quantity: quantities[i] ?? "" }));
}

function ofCoordinates({ scene, columns: { q } }: Recording, columns: Column[]): Own[] {
  return scene.coordinates.flatMap(({ name, unit }, i) => {
    const [column, moves] = [columns[i], q[i]];
    return column && moves ? [{ label: name, column, quantity: unit, moves }] : [];
  });
}

function range(column: Column): number {
  let [low, high] = [Infinity, -Infinity];
  for (const value of column.view()) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return high - low;
}
