/** Where the tool is, where it should be, and what the servo says. */
import { h, Kept, text } from "../dom";
import { fixed, short } from "../format";
import type { Pose, Quaternion, Scene, State } from "../protocol";
import { chosenUnits, digitsOf, nearestTurn, rollPitchYaw, shown, unitOf, type Quantity } from "../units";
import { facts, grid, panel, type Panel } from "./panel";

const WORDS = { moving: "moving", reached: "reached", stalled: "stalled", paused: "paused", unavailable: "not available" };
const GOOD = { moving: "", reached: "good", stalled: "bad", paused: "", unavailable: "bad" };
const POSITION = ["x", "y", "z"];
const ORIENTATION = { quaternion: ["qw", "qx", "qy", "qz"], "roll, pitch, yaw": ["roll", "pitch", "yaw"] };

export function posePanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("pose", "Pose and error", true);
  const verdict = h("span", {});
  const sentence = h("span", { class: "note" });
  const status = h("p", {}, verdict, " ", sentence);
  const limits = h("p", { class: "note" });
  const open = h("p", { class: "doubt" });
  const numbers = h("div", {});
  const kept = new Kept(numbers);
  let table = poseTable();
  let error = errorList();
  made.body.append(status, limits, open, numbers);
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
      kept.fill(chosenUnits(), () => {
        [table, error] = [poseTable(), errorList()];
        return [table.element, h("h3", {}, "Error of the task components"), error.element];
      });
      table.show(state.tool, state.target);
      error.set(0, inUnit(state.error.position, "m", 6));
      error.set(1, inUnit(state.error.orientation, "rad", 6));
    },
  };
}

function errorList(): ReturnType<typeof facts> {
  return facts([`distance [${unitOf("m")}]`, `angle [${unitOf("rad")}]`]);
}

function poseTable(): { element: HTMLElement; show: (tool: Pose, target: Pose) => void } {
  const { orientation } = chosenUnits();
  const quantities: Quantity[] = [...POSITION.map(() => "m" as const), ...ORIENTATION[orientation].map(() => (orientation === "quaternion" ? "" : "rad") as Quantity)];
  const names = [...POSITION, ...ORIENTATION[orientation]].map((name, i) => {
    const unit = unitOf(quantities[i] ?? "");
    return h("span", { "data-pose": name }, name, unit && h("span", { class: "unit" }, ` ${unit}`));
  });
  const table = grid("Pose of tool and target", ["", "tool", "target"], names);
  return {
    element: table.element,
    show(tool, target) {
      const [here, there] = orientation === "quaternion"
        ? [tool.quaternion, nearer(target.quaternion, tool.quaternion)]
        : nearerTurns(rollPitchYaw(tool.quaternion), rollPitchYaw(target.quaternion));
      const [a, b] = [[...tool.position, ...here], [...target.position, ...there]];
      names.forEach((name, i) => {
        const quantity = quantities[i] ?? "";
        name.dataset["value"] = String(a[i]);
        table.set(i, [inUnit(a[i] ?? 0, quantity, 5), inUnit(b[i] ?? 0, quantity, 5)]);
      });
    },
  };
}

function inUnit(value: number | null, quantity: Quantity, digits: number): string {
  return fixed(value === null ? null : shown(value, quantity), digitsOf(quantity, digits));
}

/** Of the two quaternions of a rotation the one nearer to another. */
function nearer(quaternion: Quaternion, to: Quaternion): Quaternion {
  const product = quaternion.reduce((sum, x, i) => sum + x * (to[i] ?? 0), 0);
  return product < 0 ? (quaternion.map((x) => -x) as Quaternion) : quaternion;
}

/** Angles of the target by a turn nearest to those of the tool. */
function nearerTurns(tool: number[], target: number[]): [number[], number[]] {
  return [tool, target.map((angle, i) => nearestTurn(angle, tool[i] ?? 0))];
}
