/**
 * Undo and redo: configurations with their targets, one for each thing that the user has done. A recording has
 * a mark for each: where one is shown, undo and redo go from mark to mark.
 *
 * It is no recording itself: that is of every state, as text, from when the user wants it, and makes the server hold
 * none back. Kept all the time it would grow by megabytes a minute, and it ends at 72 000 states; 200 moments take 50 kB.
 */
import type { Pose, ToServer } from "./protocol";
import type { Session } from "./session";
import type { Timeline } from "./timeline/timeline";

type Moment = { frame: string; q: number[]; target: Pose };

/** What moves the robot or its target; a drag or a held key sends many of one kind, which are one step. */
const MOVES: readonly ToServer["type"][] = ["joint", "configuration", "target", "twist", "frame", "null_space", "reset"];
/** Messages of one kind are one step while a button is held, or while they come closer than this (ms). */
const PAUSE = 700;
const MOST = 200;

export class History {
  private readonly past: Moment[] = [];
  private readonly future: Moment[] = [];
  private kind = "";
  private last = -Infinity;
  private held = false;
  private own = false;

  constructor(
    private readonly session: Session, private readonly timeline: Timeline,
    private readonly changed: (undo: boolean, redo: boolean) => void,
  ) {
    session.on("sending", (message) => this.sending(message));
    // Before the press is handled: it begins something new.
    addEventListener("pointerdown", () => this.press(true), true);
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => this.press(false), true);
  }

  undo(): void {
    if (!this.timeline.step(-1)) this.go(this.past, this.future);
  }

  redo(): void {
    if (!this.timeline.step(1)) this.go(this.future, this.past);
  }

  /** Another session: its past is not here. */
  clear(): void {
    this.past.length = this.future.length = 0;
    this.forget();
  }

  private press(held: boolean): void {
    this.held = held;
    if (held) this.kind = "";
    else this.last = performance.now();
  }

  private sending(message: ToServer): void {
    if (this.own || !MOVES.includes(message.type)) return;
    const now = performance.now();
    const kind = "name" in message ? `${message.type} ${message.name}` : message.type;
    const goesOn = kind === this.kind && (this.held || now - this.last < PAUSE);
    [this.kind, this.last] = [kind, now];
    const moment = this.now();
    if (goesOn || !moment) return;
    // Two messages in one state are one step.
    const last = this.past.at(-1);
    if (last?.q !== moment.q || last.frame !== moment.frame) this.past.push(moment);
    this.timeline.noteStep();
    if (this.past.length > MOST) this.past.shift();
    this.future.length = 0;
    this.tell();
  }

  private go(from: Moment[], to: Moment[]): void {
    const [moment, now] = [from.at(-1), this.now()];
    if (!moment || !now || moment.q.length !== now.q.length) return;
    from.pop();
    to.push(now);
    this.own = true;
    this.timeline.noteStep();
    if (moment.frame !== now.frame) this.session.send({ type: "frame", name: moment.frame });
    this.session.send({ type: "configuration", q: moment.q });
    this.session.send({ type: "target", ...moment.target });
    this.own = false;
    this.forget();
  }

  /** What comes next is something new. */
  private forget(): void {
    this.kind = "";
    this.tell();
  }

  private now(): Moment | null {
    const { scene, state } = this.session;
    return scene && state ? { frame: scene.frame, q: state.q, target: state.target } : null;
  }

  /** What can be undone and redone. */
  tell(): void {
    const { steps } = this.timeline;
    this.changed(steps ? steps.before : this.past.length > 0, steps ? steps.after : this.future.length > 0);
  }
}
