/** A recording as CSV: one line for each time at which the server sent a state of one of its models. */
import type { Scene, State } from "../protocol";
import type { Recording } from "./recording";
import { together, type Model } from "./together";

type Value = string | number | null | undefined;

/** The numbers of the head, SI and radians; an absent one stays empty. Columns of models beside the first begin with their names. */
export function csvOf(recording: Recording): Blob {
  const { times, models } = together(recording);
  const writers = models.map((model, k) => new Writer(model, k === 0 ? "" : `${model.name}.`));
  const lines = [["time", ...writers.flatMap(({ head }) => head)].map(cell).join(",")];
  times.forEach((time, row) => lines.push([String(time), ...writers.map((writer) => writer.at(row))].join(",")));
  return new Blob(lines.map((line) => `${line}\r\n`), { type: "text/csv" });
}

/** Writes the cells of a model. */
class Writer {
  readonly head: string[];
  private readonly scene: Scene;
  private sample = -1;
  private text: string;

  constructor(private readonly model: Model, prefix: string) {
    this.scene = model.recording.sceneAt(0);
    const names = this.scene.coordinates.map(({ name }) => name);
    const pose = (name: string): string[] => ["x", "y", "z", "qw", "qx", "qy", "qz"].map((part) => `${name}_${part}`);
    this.head = [
      ...names, ...names.map((name) => `velocity.${name}`), ...pose("tool"), ...pose("target"),
      "position_error", "orientation_error", "smallest_over_largest", "rank", "status", "limits",
    ].map((name) => prefix + name);
    this.text = this.absent;
  }

  /** The state that holds at a time is that of the line before, unless a newer one was sent. */
  at(row: number): string {
    const sample = this.model.samples[row] ?? -1;
    if (sample !== this.sample) {
      this.sample = sample;
      const state = sample < 0 ? null : this.model.recording.stateAt(sample);
      this.text = state ? this.cells(state).map(cell).join(",") : this.absent;
    }
    return this.text;
  }

  private get absent(): string {
    return ",".repeat(this.head.length - 1);
  }

  private cells({ q, servo, tool, target, error, singular }: State): Value[] {
    const { coordinates } = this.scene;
    return [
      ...q, ...coordinates.map((_, i) => servo.joint_velocities?.[i]),
      ...tool.position, ...tool.quaternion, ...target.position, ...target.quaternion,
      error.position, error.orientation, singular?.ratio, singular?.rank, servo.status,
      servo.limits.map(({ coordinate, kind }) => `${coordinates[coordinate]?.name ?? "?"} ${kind}`).join("; "),
    ];
  }
}

function cell(value: Value): string {
  const text = String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
