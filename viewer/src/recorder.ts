/** Keeps the states of the session, and gives them out as JSON or CSV. */
import type { Scene, State } from "./protocol";

/** About twenty minutes at 60 states a second of a small robot. */
const MOST = 72_000;

export class Recorder {
  recording = false;
  private states: string[] = [];

  get length(): number {
    return this.states.length;
  }

  get isFull(): boolean {
    return this.states.length >= MOST;
  }

  start(): void {
    this.states = [];
    this.recording = true;
  }

  stop(): void {
    this.recording = false;
  }

  /** A state as it came; all of them, also those that were never drawn. */
  take(raw: string): void {
    if (this.recording && !this.isFull) this.states.push(raw);
  }

  json(scene: Scene): Blob {
    const head = JSON.stringify({
      model: scene.name, frame: scene.frame, task: scene.task, method: scene.method,
      joint_names: scene.coordinates.map((coordinate) => coordinate.name),
      units: scene.coordinates.map((coordinate) => coordinate.unit),
    });
    return new Blob([head.slice(0, -1), ',"states":[\n', this.states.join(",\n"), "\n]}\n"], { type: "application/json" });
  }

  /** One line for each state: the numbers of the head, SI and radians; an absent one stays empty. */
  csv(scene: Scene): Blob {
    const pose = (name: string): string[] => ["x", "y", "z", "qw", "qx", "qy", "qz"].map((part) => `${name}_${part}`);
    const head = [
      "time", ...scene.coordinates.map((coordinate) => coordinate.name), ...pose("tool"), ...pose("target"),
      "position_error", "orientation_error", "smallest_over_largest", "rank", "status",
    ];
    const lines = this.states.map((raw) => {
      const state = JSON.parse(raw) as State;
      return [
        state.time, ...state.q, ...state.tool.position, ...state.tool.quaternion,
        ...state.target.position, ...state.target.quaternion, state.error.position, state.error.orientation,
        state.singular?.ratio, state.singular?.rank, state.servo.status,
      ].map(cell).join(",");
    });
    return new Blob([[head.map(cell).join(","), ...lines].join("\r\n"), "\r\n"], { type: "text/csv" });
  }
}

function cell(value: string | number | null | undefined): string {
  const text = String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Hands a file to the browser's downloads. */
export function download(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  const link = document.createElement("a");
  [link.href, link.download] = [url, name];
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
