/** States over time: those that the session sent, or those of a motion in a file. */
import type { Scene, State } from "../protocol";
import { Columns } from "./columns";

/** About twenty minutes at 60 states a second of a small robot. */
export const MOST = 72_000;

/** Between two samples (s). */
const LEAST = 1e-4;

/** A time of a recording, and the scene that it has there. */
export type Past = { recording: Recording; time: number; scene: Scene };

export class Recording {
  readonly columns: Columns;
  /** Of the models beside the first, by their sessions; their times are of the same clock. */
  readonly beside = new Map<string, Recording>();
  /** As the server sent them: text needs a tenth of the memory of what it describes. */
  private readonly raws: string[] = [];
  /** Each from its first state on. */
  private readonly scenes: { from: number; scene: Scene }[] = [];
  /** Of the session at time 0 (s); null until a state says it. */
  private began: number | null = null;
  /** Of the page at time 0 (ms). */
  private since = 0;

  /** `file`: the name of the file that it was read from. */
  constructor(scene: Scene, readonly file: string | null = null) {
    this.scenes.push({ from: 0, scene });
    this.columns = new Columns(scene.coordinates.length);
  }

  get length(): number {
    return this.raws.length;
  }

  get isFull(): boolean {
    return this.raws.length >= MOST;
  }

  /** Of the last state, from the first (s). */
  get duration(): number {
    return this.length > 0 ? this.columns.time.at(this.length - 1) : 0;
  }

  /** Of the last state of all models (s). */
  get end(): number {
    return Math.max(this.duration, ...[...this.beside.values()].map(({ duration }) => duration));
  }

  /** The states that follow are of this scene. */
  changeScene(scene: Scene): void {
    if (this.scenes.at(-1)?.from === this.length) this.scenes.pop();
    this.scenes.push({ from: this.length, scene });
  }

  /** Those of which there are states. */
  tracks(): [string, Recording][] {
    return [...this.beside].filter(([, { length }]) => length > 0);
  }

  /** Since time 0 (s). */
  get now(): number {
    return (performance.now() - this.since) / 1000;
  }

  /** The first state, which was computed `age` ago (s): it is at this time, and what follows counts from now. */
  begin(state: State, age: number, time = 0): void {
    this.since = performance.now() - 1000 * time;
    this.began = state.clock + age - time;
    this.take(time, JSON.stringify(state), state);
  }

  /** The line was lost: the clock of a session that begins anew does, too, and the clock of the page goes on. */
  lose(): void {
    this.began = null;
  }

  /** A state of the session, as text: when it was computed counts; after a lost line, when the first one came. */
  takeLive(raw: string, state = JSON.parse(raw) as State): void {
    this.began ??= state.clock - this.now;
    // No two samples are at one time.
    this.began = Math.min(this.began, state.clock - this.duration - LEAST);
    this.take(state.clock - this.began, raw, state);
  }

  /** A state as text, `time` after the first (s). */
  take(time: number, raw: string, state = JSON.parse(raw) as State): void {
    const { scene } = this;
    if (this.isFull || state.q.length !== scene.coordinates.length) return;
    this.columns.push(time, scene, state);
    this.raws.push(raw);
  }

  /** The newest scene. */
  get scene(): Scene {
    return this.sceneAt(Infinity);
  }

  sceneAt(index: number): Scene {
    const found = this.scenes.findLast(({ from }) => from <= index) ?? this.scenes[0];
    if (!found) throw new Error("a recording has a scene");
    return found.scene;
  }

  stateAt(index: number): State | null {
    const raw = this.raws[index];
    return raw === undefined ? null : (JSON.parse(raw) as State);
  }

  /** The last state at or before a time (s); the first one before all. */
  stateBefore(time: number): State | null {
    return this.stateAt(this.columns.indexAt(time));
  }

  /** Scenes, each from its first state on. */
  parts(): readonly { from: number; scene: Scene }[] {
    return this.scenes;
  }

  /** All states, one a line. */
  lines(): Blob {
    return new Blob([this.raws.join("\n")]);
  }

  json(): Blob {
    const beside = this.tracks().flatMap(([session, one], i) => [i === 0 ? ',"beside":[\n' : ",\n", ...one.text({ session }), "}"]);
    return new Blob([...this.text({}), ...beside, beside.length > 0 ? "]}\n" : "}\n"], { type: "application/json" });
  }

  /** As JSON without the last brace. */
  private text(more: object): string[] {
    const scene = this.sceneAt(0);
    const head = JSON.stringify({
      ...more,
      model: scene.name, frame: scene.frame, task: scene.task, method: scene.method,
      joint_names: scene.coordinates.map((coordinate) => coordinate.name),
      units: scene.coordinates.map((coordinate) => coordinate.unit),
      times: [...this.columns.time.view()],
    });
    return [head.slice(0, -1), ',"states":[\n', this.raws.join(",\n"), "\n]"];
  }
}
