/** Position and orientation of something as number fields: an alternative to dragging. */
import { h } from "../dom";
import type { Pose, Quaternion, Vec3 } from "../protocol";
import { chosenUnits, inUnits, ofRollPitchYaw, rollPitchYaw, withUnit } from "../units";
import { QuantityField } from "../quantity_field";

const AXES = ["x", "y", "z"] as const;
const ANGLES = ["roll", "pitch", "yaw"] as const;
const PARTS = ["qw", "qx", "qy", "qz"] as const;

type Named = { label: (part: string) => string; mark: (part: string) => Record<string, string>; orientation: boolean };

export class PoseFields {
  readonly element: HTMLElement;
  private readonly position: QuantityField[];
  private readonly angles: QuantityField[] = [];
  private readonly quaternion: QuantityField[] = [];
  private pose: Pose | null = null;

  /** `label` of each field without its unit; `send` gets the pose with the typed part, the others to their last digit. */
  constructor({ label, mark, orientation }: Named, private readonly send: (pose: Pose) => void) {
    const field = (quantity: "m" | "rad" | "", part: string, changed: (value: number) => void): QuantityField =>
      new QuantityField(quantity, (unit) => label(part) + (unit && ` (${unit})`), changed, mark(part));
    this.position = AXES.map((axis, i) => field("m", axis, (value) => this.typed((pose) => ({ ...pose, position: put(pose.position, i, value) }))));
    const row = (fields: QuantityField[]): HTMLElement => h("div", { class: fields.length === 4 ? "four" : "three" }, ...fields.map(({ element }) => element));
    this.element = h("div", { class: "pose-fields" }, withUnit(h("p", { class: "note" }), "m", (unit) => `Position x, y, z [${unit}]`), row(this.position));
    if (!orientation) return;
    this.angles = ANGLES.map((angle, i) => field("rad", angle, (value) => this.typed((pose) => ({ ...pose, quaternion: ofRollPitchYaw(put(rollPitchYaw(pose.quaternion), i, value)) }))));
    this.quaternion = PARTS.map((part, i) => field("", part, (value) => this.typed((pose) => ({ ...pose, quaternion: put(pose.quaternion, i, value) }))));
    const angles = h("div", {}, withUnit(h("p", { class: "note" }), "rad", (unit) => `Roll, pitch, yaw [${unit}]`), row(this.angles));
    const quaternion = h("div", {}, h("p", { class: "note" }, "Quaternion w, x, y, z"), row(this.quaternion));
    this.element.append(angles, quaternion);
    inUnits(this.element, () => {
      const isQuaternion = chosenUnits().orientation === "quaternion";
      [angles.hidden, quaternion.hidden] = [isQuaternion, !isQuaternion];
      if (this.pose) this.show(this.pose);
    });
  }

  show(pose: Pose): void {
    this.pose = pose;
    this.position.forEach((field, i) => field.show(pose.position[i] ?? 0));
    if (chosenUnits().orientation === "quaternion") this.quaternion.forEach((field, i) => field.show(pose.quaternion[i] ?? 0));
    else if (this.angles.length > 0) rollPitchYaw(pose.quaternion).forEach((angle, i) => this.angles[i]?.show(angle));
  }

  private typed(change: (pose: Pose) => Pose): void {
    if (!this.pose) return;
    this.pose = change(this.pose);
    this.send(this.pose);
  }
}

function put<T extends Vec3 | Quaternion>(values: T, at: number, value: number): T {
  return values.map((was, i) => (i === at ? value : was)) as T;
}
