/** The plots of a recording: which are shown, their width, their picture. */
import { h, text, type Child } from "../dom";
import { panel } from "../panels/panel";
import { colour, onTheme } from "../theme";
import { inUnits } from "../units";
import { Chart, MARKS, type Style } from "./chart";
import { lastAt } from "./columns";
import { KINDS } from "./kinds";
import type { Recording } from "./recording";
import { together, type Together } from "./together";

/** While a recording grows it is plotted again after this time (ms). */
const PAUSE = 250;
const SHOWN_FIRST = ["joints", "singular"];
/** Parts of a line of 12 pixels that are drawn: where they begin, and how long they are. */
const SWATCHES: Record<Style, [number, number][]> = { solid: [[0, 12]], dashed: [[0, 5], [8, 4]], dotted: [[0, 2], [5, 2], [10, 2]] };

export class Plots {
  readonly panel = panel("plots", "Plots", true);
  private readonly charts = new Map<string, Chart>();
  private readonly list = h("div", { class: "charts" });
  private readonly whose = h("span", {});
  private recording: Recording | null = null;
  private all: Together | null = null;
  private width = 0;
  private timer = 0;
  private moment = { index: 0, time: 0 };

  /** `saves`: buttons in one group, and what comes after them. */
  constructor(private readonly seek: (time: number) => void, saves: Child[] = [], after: Child = null) {
    const chips = KINDS.map((kind) => {
      const button = h("button", { class: "button small", type: "button", "aria-pressed": String(SHOWN_FIRST.includes(kind.name)), onclick: () => {
        const shown = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(shown));
        if (shown) this.add(kind.name);
        else this.remove(kind.name);
        this.draw();
      } }, kind.title);
      return button;
    });
    this.panel.body.append(
      h("div", { class: "row" },
        h("span", { class: "chips", role: "group", "aria-label": "Plots shown" }, ...chips),
        saves.length > 0 && h("span", { class: "group", role: "group", "aria-label": "Save" }, ...saves), after),
      h("p", { class: "note marks" }, ...MARKS.flatMap(({ name, words }) => [h("span", { class: `mark ${name}` }), `${words} `]), this.whose),
      this.list,
    );
    for (const name of SHOWN_FIRST) this.add(name);
    this.panel.onToggle(() => this.draw());
    onTheme(() => this.draw());
    inUnits(this.panel.element, () => this.draw());
    new ResizeObserver(() => {
      if (this.list.clientWidth === this.width) return;
      this.draw();
    }).observe(this.list);
  }

  /** Another recording, or none. */
  show(recording: Recording | null): void {
    [this.recording, this.all] = [recording, null];
    this.draw();
  }

  /** The recording has become longer. */
  grow(): void {
    this.timer ||= window.setTimeout(() => this.draw(), PAUSE);
  }

  at(index: number, time: number): void {
    this.moment = { index, time };
    const row = this.all ? lastAt(this.all.times, time) : 0;
    if (this.panel.isOpen()) for (const chart of this.charts.values()) chart.at(index, time, row);
  }

  /** All plots that are shown, one below the other. */
  picture(): Promise<Blob> {
    const shown = [...this.charts.values()].flatMap((chart) => (chart.canvas ? [{ chart, canvas: chart.canvas }] : []));
    if (shown.length === 0) return Promise.reject(new Error("no plot is shown"));
    const scale = devicePixelRatio;
    const [title, line] = [22 * scale, 20 * scale];
    const canvas = document.createElement("canvas");
    const context = canvas.getContext("2d");
    if (!context) return Promise.reject(new Error("this browser does not support 2D canvases"));
    const width = Math.max(...shown.map((one) => one.canvas.width));
    const font = `${11 * scale}px system-ui, sans-serif`;
    context.font = font;
    const legends = shown.map(({ chart }) => legendOf(context, chart.entries, width, scale));
    const marks = legendOf(context, MARKS.map(({ words, colour: name }) => ({ label: words, colour: colour(name), style: "solid" as const })), width, scale);
    canvas.width = width;
    canvas.height = shown.reduce((sum, one, i) => sum + one.canvas.height + title + line * rowsOf(legends[i]), line * rowsOf(marks));
    context.fillStyle = colour("panel");
    context.fillRect(0, 0, canvas.width, canvas.height);
    const write = (legend: Entry[], from: number): void => {
      context.font = font;
      for (const { label, ink, style, x, row } of legend) {
        context.fillStyle = ink;
        for (const [at, wide] of SWATCHES[style]) {
          context.fillRect(x + at * scale, from + row * line + 5 * scale, wide * scale, 3 * scale);
        }
        context.fillStyle = colour("ink");
        context.fillText(label, x + 16 * scale, from + row * line + 11 * scale);
      }
    };
    let y = 0;
    for (const [i, { chart, canvas: drawn }] of shown.entries()) {
      const legend = legends[i] ?? [];
      context.font = `600 ${13 * scale}px system-ui, sans-serif`;
      context.fillStyle = colour("ink");
      context.fillText(chart.element.querySelector("figcaption")?.textContent ?? "", 8 * scale, y + 15 * scale);
      context.drawImage(drawn, 0, y + title);
      y += title + drawn.height;
      write(legend, y);
      y += line * rowsOf(legend);
    }
    write(marks, y);
    return new Promise((resolve, reject) => canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture could not be encoded"))), "image/png"));
  }

  private add(name: string): void {
    const kind = KINDS.find((one) => one.name === name);
    if (!kind) return;
    this.charts.set(name, new Chart(kind, this.seek));
    const order = KINDS.flatMap((one) => this.charts.get(one.name)?.element ?? []);
    this.list.replaceChildren(...order);
  }

  private remove(name: string): void {
    this.charts.get(name)?.destroy();
    this.charts.delete(name);
  }

  private draw(): void {
    clearTimeout(this.timer);
    this.timer = 0;
    this.width = this.list.clientWidth;
    if (!this.recording || this.recording.length === 0 || !this.panel.isOpen() || this.width === 0) return;
    const all = (this.all = together(this.recording));
    text(this.whose, all.models.length > 1 ? `(${all.models[0]?.name} alone; lines of models beside it are dotted)` : "");
    for (const chart of this.charts.values()) chart.show(all);
    this.at(this.moment.index, this.moment.time);
  }
}

type Entry = { label: string; ink: string; style: Style; x: number; row: number };

/** Rows of a legend, one at least. */
function rowsOf(legend: Entry[] = []): number {
  return (legend.at(-1)?.row ?? 0) + 1;
}

/** Where the names of lines are in a picture: in rows that end within its width; the end of a longer name is left out. */
function legendOf(context: CanvasRenderingContext2D, entries: { label: string; colour: string; style: Style }[], width: number, scale: number): Entry[] {
  const [left, gap, swatch] = [52 * scale, 14 * scale, 16 * scale];
  let [x, row] = [left, 0];
  return entries.map(({ label: whole, colour: ink, style }) => {
    const label = shortened(context, whole, width - left - swatch);
    const wide = swatch + context.measureText(label).width;
    if (x > left && x + wide > width) [x, row] = [left, row + 1];
    const place = { label, ink, style, x, row };
    x += wide + gap;
    return place;
  });
}

/** As much of a text as this width has room for. */
function shortened(context: CanvasRenderingContext2D, text: string, width: number): string {
  if (context.measureText(text).width <= width) return text;
  let length = text.length;
  while (length > 0 && context.measureText(`${text.slice(0, length)}…`).width > width) length -= 1;
  return `${text.slice(0, length)}…`;
}
