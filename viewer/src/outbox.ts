/** Holds back what is dragged: one message under way, and of each kind only the newest after it. */
import type { ToServer } from "./protocol";

/** An answer that does not come is not waited for longer (ms). */
const PATIENCE = 250;

export class Outbox {
  private readonly waiting = new Map<string, ToServer>();
  private underWay: number | null = null;
  private timer = 0;

  constructor(private readonly send: (message: ToServer) => number | null) {}

  put(key: string, message: ToServer): void {
    this.waiting.set(key, message);
    if (this.underWay === null && !this.timer) this.timer = window.setTimeout(() => this.flush(), 8);
  }

  /** Ids grow: an answer to a later message answers all before it. */
  answered(id: unknown): void {
    if (typeof id !== "number" || this.underWay === null || id < this.underWay) return;
    this.flush();
  }

  clear(): void {
    clearTimeout(this.timer);
    this.waiting.clear();
    [this.underWay, this.timer] = [null, 0];
  }

  private flush(): void {
    clearTimeout(this.timer);
    [this.underWay, this.timer] = [null, 0];
    const messages = [...this.waiting.values()];
    this.waiting.clear();
    for (const message of messages) this.underWay = this.send(message);
    if (this.underWay !== null) this.timer = window.setTimeout(() => this.flush(), PATIENCE);
  }
}
