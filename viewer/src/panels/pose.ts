/** Where the tool is, where it should be, and what the servo says. */
import { fill, h } from "../dom";
import { fixed, short } from "../format";
import type { Pose, Quaternion, Scene, State } from "../protocol";
import { numbers, pairs, panel, type Panel } from "./panel";

const WORDS = { moving: "moving", reached: "reached", stalled: "stalled", paused: "paused", unavailable: "not available" };

export function posePanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("pose", "Pose and error", true);
  const table = h("div", {});
  const servo = h("div", {});
  made.body.append(servo, table);
  return {
    ...made,
    show(scene, state) {
      const { status, sentence, limits } = state.servo;
      made.note(`${scene.frame} in world`);
      const names = limits.map((limit) => `${scene.coordinates[limit.coordinate]?.name ?? "?"} (${limit.kind})`);
      fill(
        servo,
        h("p", { "data-status": status }, h("span", { class: `verdict ${status === "reached" ? "good" : status === "stalled" || status === "unavailable" ? "bad" : ""}` }, WORDS[status]), " ", h("span", { class: "note" }, sentence)),
        names.length > 0 && h("p", { class: "note" }, `At limits: ${names.join(", ")}`),
        state.closure_error && !state.closure_error.closed &&
          h("p", { class: "doubt" }, `Loops are open by ${short(state.closure_error.distance)} m, ${short(state.closure_error.angle)} rad`),
      );
      fill(
        table,
        numbers("Pose of tool and target", ["", "tool", "target"], [
          ...rows("position", ["x", "y", "z"], state, "m"),
          ...rows("quaternion", ["qw", "qx", "qy", "qz"], state, ""),
        ]),
        h("h3", {}, "Error of the task components"),
        pairs(["distance [m]", fixed(state.error.position, 6)], ["angle [rad]", fixed(state.error.orientation, 6)]),
      );
    },
  };
}

/** Of the two quaternions of a rotation the one nearer to another. */
function nearer(quaternion: Quaternion, to: Quaternion): Quaternion {
  const product = quaternion.reduce((sum, x, i) => sum + x * (to[i] ?? 0), 0);
  return product < 0 ? (quaternion.map((x) => -x) as Quaternion) : quaternion;
}

function rows(field: keyof Pose, names: string[], { tool, target: desired }: State, unit: string): (string | Node)[][] {
  const target = { ...desired, quaternion: nearer(desired.quaternion, tool.quaternion) };
  return names.map((name, i) => [
    h("span", { "data-pose": name, "data-value": tool[field][i] ?? "" }, name, unit && h("span", { class: "unit" }, ` ${unit}`)),
    fixed(tool[field][i], 5),
    fixed(target[field][i], 5),
  ]);
}
