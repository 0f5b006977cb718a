/** Asks the server for poses and measures at configurations in which the session is not. */
import type { Posture, Scene } from "../protocol";
import type { Session } from "../session";

/** Configurations of one message: the server takes at most these, and messages of 64 KiB. */
const MOST = 64;
const LONGEST = 60_000;

/** `epoch`: the scene for which they are asked. */
type Waiting = { q: number[][]; full: boolean; epoch: number; resolve: (states: Posture[]) => void; reject: (error: Error) => void };

export class Elsewhere {
  private readonly waiting = new Map<number, Waiting>();
  private readonly asked = new Set<number>();
  /** Counts scenes. Each comes before the first answer that is of it. */
  private epoch = 0;

  constructor(private readonly session: Session) {
    session.on("scene", () => (this.epoch += 1));
    session.on("states", ({ reply_to, states }) => {
      const one = this.take(reply_to);
      if (one?.epoch === this.epoch) one.resolve(states);
      // They may be of the frame or the model before: asked again.
      else if (one) this.send(one);
    });
    session.on("failure", ({ reply_to, message }) => this.take(reply_to)?.reject(new Error(message)));
    session.on("link", ({ link }) => {
      if (link === "open") return;
      for (const one of this.waiting.values()) one.reject(new Error("The connection to the server was lost."));
      this.waiting.clear();
    });
  }

  /** Whether an error answers one of these questions. */
  owns(id: unknown): boolean {
    return typeof id === "number" && this.asked.has(id);
  }

  /** At most as many as one message has; `full`: with overlays and distances. */
  ask(q: number[][], full: boolean): Promise<Posture[]> {
    return new Promise((resolve, reject) => this.send({ q, full, epoch: 0, resolve, reject }));
  }

  /** Of many configurations, message by message; stops after `false`. False where they are not of one scene, the first ones of that before. */
  async askAll(q: number[][], each: (i: number, posture: Posture) => void, goesOn: (done: number) => boolean): Promise<boolean> {
    const { epoch } = this;
    for (let from = 0; from < q.length; ) {
      let [to, size] = [from, 0];
      while (to < q.length && to - from < MOST && (size === 0 || size < LONGEST)) {
        size += JSON.stringify(q[to]).length + 1;
        if (size < LONGEST || to === from) to += 1;
      }
      const postures = await this.ask(q.slice(from, to), false);
      if (this.epoch !== epoch) return false;
      postures.forEach((posture, i) => each(from + i, posture));
      from = to;
      if (!goesOn(to)) return true;
    }
    return true;
  }

  private send(one: Waiting): void {
    const id = this.session.send({ type: "states", q: one.q, full: one.full });
    if (id === null) {
      one.reject(new Error("There is no connection to the server."));
      return;
    }
    this.asked.add(id);
    this.waiting.set(id, { ...one, epoch: this.epoch });
  }

  private take(id: unknown): Waiting | undefined {
    const waiting = typeof id === "number" ? this.waiting.get(id) : undefined;
    if (waiting) this.waiting.delete(id as number);
    return waiting;
  }
}

const measured = new WeakMap<Scene, string>();

/** Whether overlays of both would be the same at the same configuration. */
export function measuresAlike(one: Scene, other: Scene): boolean {
  return measuredBy(one) === measuredBy(other);
}

function measuredBy(scene: Scene): string {
  let parts = measured.get(scene);
  if (parts === undefined) {
    const { joints, loops, contacts, frame, frames, task, actuators } = scene;
    parts = JSON.stringify([joints, loops, contacts, frame, frames, task, actuators]);
    measured.set(scene, parts);
  }
  return parts;
}
