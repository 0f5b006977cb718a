/** The row below the view that plays a recording: its time, speed and trail. */
import { fill, h, s, text } from "../dom";
import { fixed } from "../format";
import { icon, type Icon } from "../icons";
import { MARKS } from "./chart";
import type { Columns } from "./columns";
import type { Player } from "./player";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
/** Steps of the page keys through a recording. */
const PAGES = 20;
/** Pixels. */
const STRIPE = 3;
const THUMB = 14;

export class Dock {
  private readonly play = button("Play back", "play");
  private readonly loop = button("Loop", "loop");
  private readonly trail = button("Trail of the tool", "trail");
  private readonly live = h("button", { class: "button small", type: "button", title: "Back to the robot as it is" }, "live");
  private readonly slider = h("input", { type: "range", min: 0, max: 1, step: "any", "aria-label": "Time of the recording [s]" });
  private readonly time = h("span", { class: "number" });
  private readonly marks = s("svg", { class: "dock-marks", "aria-hidden": "true" });
  private readonly speed = h(
    "select", { class: "select", "aria-label": "Speed of playing back", title: "Speed" },
    ...SPEEDS.map((speed) => h("option", { value: speed, selected: speed === 1 }, `${speed} ×`)),
  );
  private columns: Columns | null = null;
  private end = 0;

  /** `live` is called to leave the recording (not where there is nothing else), `trail` to show the trail or not. */
  constructor(readonly element: HTMLElement, private readonly player: Player, actions: { live?: () => void; trail: (shown: boolean) => void }) {
    element.append(
      this.play, h("span", { class: "dock-time" }, this.marks, this.slider), this.time, this.speed,
      h("span", { class: "group" }, this.loop, this.trail), ...(actions.live ? [this.live] : []),
    );
    this.play.addEventListener("click", () => (player.playing ? player.pause() : player.play()));
    this.loop.addEventListener("click", () => {
      player.loops = !player.loops;
      press(this.loop, player.loops);
    });
    this.trail.addEventListener("click", () => {
      press(this.trail, this.trail.getAttribute("aria-pressed") !== "true");
      actions.trail(this.trail.getAttribute("aria-pressed") === "true");
    });
    this.live.addEventListener("click", () => actions.live?.());
    this.speed.addEventListener("change", () => (player.speed = Number(this.speed.value)));
    this.slider.addEventListener("input", () => {
      player.pause();
      player.seek(this.slider.valueAsNumber);
    });
    this.slider.addEventListener("keydown", (event) => this.step(event));
    press(this.loop, false);
    press(this.trail, true);
    new ResizeObserver(() => this.paint()).observe(this.slider);
  }

  /** A recording, or one that has become longer. */
  show(columns: Columns, end: number): void {
    this.columns = columns;
    this.end = end;
    this.slider.max = String(Math.max(end, 1e-3));
  }

  /** Draws the marks of the recording. */
  paint(): void {
    const { columns, end } = this;
    const width = this.slider.clientWidth;
    if (!columns || width === 0 || end === 0) return;
    // The thumb does not go beyond the ends.
    const across = width - THUMB;
    const place = (time: number): number => THUMB / 2 + (time / end) * across;
    const steps = columns.steps().map((time) => s("rect", { class: "mark-step", x: place(time), y: 0, height: 2 * STRIPE + 1, width: 1.5 }));
    fill(this.marks, ...MARKS.flatMap(({ mark, name }, row) => columns.stretches(mark).map(([from, to]) => s("rect", {
      class: `mark-${name}`, x: place(from), y: row * (STRIPE + 1), height: STRIPE, width: Math.max(((to - from) / end) * across, 1.5),
    }))), ...steps);
  }

  /** The moment that is shown; `isLive`: it is the robot as it is. */
  at(time: number, isLive: boolean): void {
    this.slider.value = String(time);
    this.slider.style.setProperty("--filled", `${this.end > 0 ? ((100 * time) / this.end).toFixed(2) : 100}%`);
    const [now, all] = [fixed(time, 2), fixed(this.end, 2)];
    this.slider.setAttribute("aria-valuetext", `${now} s of ${all} s`);
    text(this.time, `${now} / ${all} s`);
    press(this.live, isLive);
  }

  playing(playing: boolean): void {
    const label = playing ? "Pause playback" : "Play back";
    this.play.title = label;
    this.play.setAttribute("aria-label", label);
    fill(this.play, icon(playing ? "pause" : "play"));
  }

  /** From sample to sample. */
  private step(event: KeyboardEvent): void {
    const { columns, player, end } = this;
    const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    const page = { PageUp: 1, PageDown: -1 }[event.key];
    if (!columns || (way === undefined && page === undefined)) return;
    event.preventDefault();
    player.pause();
    const here = columns.indexAt(player.time);
    const next = Math.min(Math.max(here + (way ?? 0), 0), columns.time.length - 1);
    player.seek(page === undefined ? columns.time.at(next) : player.time + (page * end) / PAGES);
  }
}

function button(label: string, name: Icon): HTMLButtonElement {
  return h("button", { class: "button small", type: "button", title: label, "aria-label": label }, icon(name));
}

function press(element: HTMLElement, pressed: boolean): void {
  element.setAttribute("aria-pressed", String(pressed));
}
