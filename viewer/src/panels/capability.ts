/** Manipulability: the efficiencies printed by the command line. */
import { fill, h } from "../dom";
import { short } from "../format";
import { empty, numbers, pairs, panel } from "./panel";
import { listIn, numberIn, objectIn, type Watch } from "./reports";

const KINDS: [string, string][] = [
  ["kinematic", "motion"],
  ["active_force", "active force"],
  ["passive_force", "passive force"],
  ["internal_force", "internal force"],
];
const MEASURES = ["volume", "largest", "smallest", "anisotropy"];

export function capabilityPanel(): Watch {
  const made = panel("capability", "Manipulability", false);
  return {
    panel: made,
    fail: (sentence) => fill(made.body, empty(sentence)),
    show(report) {
      made.note(`metric ${String(report["metric"] ?? "")}`);
      const all = KINDS.map(([key, words]) => {
        const part = objectIn(report, key);
        const finite = listIn(part, "finite").filter((value) => typeof value === "number");
        return { key, words, finite, infinite: numberIn(part, "infinite") ?? 0, zeros: numberIn(part, "zeros") ?? 0 };
      });
      // Most mechanisms have nothing to squeeze.
      const parts = all.filter(({ key, finite, infinite }) => key !== "internal_force" || finite.length + infinite > 0);
      const columns = parts.map(({ finite, infinite, zeros }) => [
        ...Array.from({ length: infinite }, () => "∞"), ...finite.map((value) => short(value, 4)), ...Array.from({ length: zeros }, () => "0"),
      ]);
      const rows = Array.from({ length: Math.max(...columns.map((column) => column.length)) }, (_, i) => [String(i + 1), ...columns.map((column) => column[i] ?? "")]);
      const measures = objectIn(report, "measures");
      fill(
        made.body,
        h("h3", {}, "Efficiencies (squared output / input)"),
        numbers("Efficiencies", ["", ...parts.map((part) => part.words)], rows),
        h("h3", {}, "Measures"),
        numbers("Measures", ["", "motion", "force"], MEASURES.map((key) => [key, ...["kinematic", "force"].map((side) => short(numberIn(objectIn(measures, side), key), 4))])),
        pairs(["actuated", listIn(report, "actuated").join(", ") || "all"]),
        ...parts.map(({ key, finite }) => h("span", { hidden: true, "data-efficiency": key, "data-values": JSON.stringify(finite) })),
      );
    },
  };
}
