/** The moment of a recording that is shown, and its motion through time. */

/** Nearer to the end than this it is the end: the slider rounds its value (s). */
const AT_END = 1e-6;

export class Player {
  /** From the first sample (s). */
  time = 0;
  playing = false;
  speed = 1;
  loops = false;
  private last = 0;
  private end = 0;

  /** `moved`: the time has changed; `changed`: it plays or does not. */
  constructor(private readonly moved: () => void, private readonly changed: () => void) {}

  /** Of another recording, or of a longer one (s). */
  setEnd(end: number): void {
    this.end = end;
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.moved();
  }

  play(): void {
    if (this.playing || this.end === 0) return;
    if (this.end - this.time < AT_END) this.time = 0;
    this.playing = true;
    this.last = performance.now();
    this.changed();
    requestAnimationFrame((now) => this.tick(now));
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    this.changed();
  }

  private tick(now: number): void {
    if (!this.playing) return;
    const next = this.time + (Math.max(now - this.last, 0) / 1000) * this.speed;
    this.last = now;
    if (next < this.end) this.seek(next);
    else if (this.loops) this.seek(next % this.end);
    else {
      this.seek(this.end);
      this.pause();
      return;
    }
    requestAnimationFrame((later) => this.tick(later));
  }
}
