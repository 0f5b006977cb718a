/** What can be plotted over time. */
import type { Coordinate } from "../protocol";
import type { Quantity } from "../units";
import type { Column } from "./columns";
import type { Recording } from "./recording";

export type Line = { label: string; column: Column; quantity: Quantity };
export type Kind = {
  name: string; title: string;
  /** After the unit of a line. */
  per: "" | "/s";
  logarithmic: boolean;
  lines: (recording: Recording) => Line[];
  /** Said beside the unit. */
  remark?: (recording: Recording) => string;
  /** Said where no sample has a value. */
  none: string;
};

/** Of more coordinates, those that move most are plotted. */
export const MOST_LINES = 12;

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
    lines: ({ columns }) => [...lines(columns.singular.map((_, i) => `σ${i + 1}`), columns.singular, []), { label: "threshold", column: columns.threshold, quantity: "" }],
  },
  { name: "margins", title: "Distances to limits", per: "", logarithmic: false, lines: (r) => ofCoordinates(r, r.columns.margins), none: "No coordinate has a limit." },
];

function lines(labels: string[], columns: Column[], quantities: Quantity[]): Line[] {
  return columns.map((column, i) => ({ label: labels[i] ?? "", column, quantity: quantities[i] ?? "" }));
}

function ofCoordinates({ scene, columns: { q } }: Recording, columns: Column[]): Line[] {
  const all = scene.coordinates.map(({ name, unit }: Coordinate, i) => ({ i, name, unit, range: range(q[i]) }));
  const most = [...all].sort((a, b) => b.range - a.range).slice(0, MOST_LINES).map(({ i }) => i);
  const kept = all.length > MOST_LINES ? all.filter(({ i }) => most.includes(i)) : all;
  return kept.flatMap(({ i, name, unit }) => {
    const column = columns[i];
    return column ? [{ label: name, column, quantity: unit }] : [];
  });
}

function range(column: Column | undefined): number {
  let [low, high] = [Infinity, -Infinity];
  for (const value of column?.view() ?? []) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return high - low;
}
