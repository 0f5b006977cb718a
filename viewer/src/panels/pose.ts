/** Where the tool is, where it should be, and what the servo says. */
import { h, text } from "../dom";
import { fixed, short } from "../format";
import type { Quaternion, Scene, State } from "../protocol";
import { facts, grid, panel, type Panel } from "./panel";

const WORDS = { moving: "moving", reached: "reached", stalled: "stalled", paused: "paused", unavailable: "not available" };
const GOOD = { moving: "", reached: "good", stalled: "bad", paused: "", unavailable: "bad" };
const ROWS = ["x", "y", "z", "qw", "qx", "qy", "qz"];

export function posePanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("pose", "Pose and error", true);
  const verdict = h("span", {});
  const sentence = h("span", { class: "note" });
  const status = h("p", {}, verdict, " ", sentence);
  const limits = h("p", { class: "note" });
  const open = h("p", { class: "doubt" });
  const names = ROWS.map((name, i) => h("span", { "data-pose": name }, name, i < 3 && h("span", { class: "unit" }, " m")));
  const table = grid("Pose of tool and target", ["", "tool", "target"], names);
  const error = facts(["distance [m]", "angle [rad]"]);
  made.body.append(status, limits, open, table.element, h("h3", {}, "Error of the task components"), error.element);
  return {
    ...made,
    show(scene, state) {
      made.note(`${scene.frame} in world`);
      if (!made.isOpen()) return;
      const { servo, closure_error: closure } = state;
      status.dataset["status"] = servo.status;
      verdict.className = `verdict ${GOOD[servo.status]}`;
      text(verdict, WORDS[servo.status]);
      text(sentence, servo.sentence);
      const stops = servo.limits.map((limit) => `${scene.coordinates[limit.coordinate]?.name ?? "?"} (${limit.kind})`);
      limits.hidden = stops.length === 0;
      text(limits, `At limits: ${stops.join(", ")}`);
      open.hidden = !closure || closure.closed;
      if (closure) text(open, `Loops are open by ${short(closure.distance)} m, ${short(closure.angle)} rad`);
      const tool = [...state.tool.position, ...state.tool.quaternion];
      const target = [...state.target.position, ...nearer(state.target.quaternion, state.tool.quaternion)];
      names.forEach((name, i) => {
        name.dataset["value"] = String(tool[i]);
        table.set(i, [fixed(tool[i], 5), fixed(target[i], 5)]);
      });
      error.set(0, fixed(state.error.position, 6));
      error.set(1, fixed(state.error.orientation, 6));
    },
  };
}

/** Of the two quaternions of a rotation the one nearer to another. */
function nearer(quaternion: Quaternion, to: Quaternion): Quaternion {
  const product = quaternion.reduce((sum, x, i) => sum + x * (to[i] ?? 0), 0);
  return product < 0 ? (quaternion.map((x) => -x) as Quaternion) : quaternion;
}
