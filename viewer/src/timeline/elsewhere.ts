/** Asks the server for poses and measures at configurations in which the session is not. */
import type { Posture } from "../protocol";
import type { Session } from "../session";

/** Configurations of one message: the server takes at most these, and messages of 64 KiB. */
const MOST = 64;
const LONGEST = 60_000;

type Waiting = { resolve: (states: Posture[]) => void; reject: (error: Error) => void };

export class Elsewhere {
  private readonly waiting = new Map<number, Waiting>();
  private readonly asked = new Set<number>();

  constructor(private readonly session: Session) {
    session.on("states", ({ reply_to, states }) => this.take(reply_to)?.resolve(states));
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
    return new Promise((resolve, reject) => {
      const id = this.session.send({ type: "states", q, full });
      if (id === null) {
        reject(new Error("There is no connection to the server."));
        return;
      }
      this.asked.add(id);
      this.waiting.set(id, { resolve, reject });
    });
  }

  /** Of many configurations, message by message; stops after `false`. */
  async askAll(q: number[][], each: (i: number, posture: Posture) => void, goesOn: (done: number) => boolean): Promise<void> {
    for (let from = 0; from < q.length; ) {
      let [to, size] = [from, 0];
      while (to < q.length && to - from < MOST && (size === 0 || size < LONGEST)) {
        size += JSON.stringify(q[to]).length + 1;
        if (size < LONGEST || to === from) to += 1;
      }
      const postures = await this.ask(q.slice(from, to), false);
      postures.forEach((posture, i) => each(from + i, posture));
      from = to;
      if (!goesOn(to)) return;
    }
  }

  private take(id: unknown): Waiting | undefined {
    const waiting = typeof id === "number" ? this.waiting.get(id) : undefined;
    if (waiting) this.waiting.delete(id as number);
    return waiting;
  }
}
