/** The mobility report: motions, idle joints, overconstraint and singularities. */
import { fill, h } from "../dom";
import { count, short } from "../format";
import { empty, pairs, panel } from "./panel";
import { listIn, numberIn, objectIn, type Watch } from "./reports";

type Json = Record<string, unknown>;
const COUNTS: [string, string][] = [
  ["dof", "degrees of freedom"],
  ["finite_dof", "finite degrees of freedom"],
  ["coordinate", "controllable object motions"],
  ["redundancy", "redundancy"],
  ["indeterminacy", "indeterminacy"],
  ["idle", "idle motions"],
  ["internal", "internal torques"],
  ["zero_torque", "wrenches resisted without torque"],
  ["hyperstatic", "hyperstatic forces"],
];
const DISTANCES: [string, string][] = [
  ["type_i", "type I (motion lost)"],
  ["type_ii", "type II (uncontrolled motion)"],
  ["configuration_space", "configuration space"],
  ["passive", "passive"],
];

export function mobilityPanel(): Watch {
  const made = panel("mobility", "Mobility", false);
  fill(made.body, empty("Waiting for the server."));
  return {
    panel: made,
    fail: (sentence) => fill(made.body, empty(sentence)),
    show(report) {
      const singularity = objectIn(report, "singularity");
      const distances = objectIn(singularity, "distances");
      const kinds = listIn(singularity, "kinds").map(String);
      const dof = numberIn(report, "dof");
      made.note(dof === null ? "" : count(dof, "motion"));
      const known = DISTANCES.filter(([key]) => distances[key] !== undefined && distances[key] !== null);
      fill(
        made.body,
        h("p", {}, singularity["regular"] === false
          ? h("span", { class: "verdict bad" }, `Singular: ${kinds.join(", ") || "a motion is lost or uncontrolled"}`)
          : h("span", { class: "verdict good" }, "Regular configuration")),
        h("h3", {}, "Counts"),
        pairs(...COUNTS.filter(([key]) => key in report).map(([key, words]): [string, string] => [words, text(report[key])])),
        known.length > 0 && h("h3", {}, "Distance to singularities (0: singular)"),
        known.length > 0 && pairs(...known.map(([key, words]): [string, string] => [words, short(numberIn(distances, key))])),
        motions(report),
        ...listIn(report, "ambiguous_ranks").map((doubt) => h("p", { class: "doubt" }, String(doubt))),
        h("p", { class: "note" }, `Ranks with lengths relative to ${short(numberIn(report, "length"))} m`),
      );
    },
  };
}

function text(value: unknown): string {
  return typeof value === "number" ? String(value) : "–";
}

function motions(report: Json): HTMLElement | null {
  const joints = listIn(report, "joints") as Json[];
  const still = joints.filter((joint) => joint["moves"] === false).map((joint) => String(joint["joint"]));
  const idle = joints.filter((joint) => joint["idle"] === true).map((joint) => String(joint["joint"]));
  if (still.length + idle.length === 0) return null;
  return h(
    "div", {},
    still.length > 0 && h("p", { class: "note" }, `${count(still.length, "joint")} cannot move: ${still.join(", ")}`),
    idle.length > 0 && h("p", { class: "note" }, `Idle: ${idle.join(", ")}`),
  );
}
