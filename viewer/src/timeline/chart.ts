/** A plot over time, with marks where limits and singularities bit and a line at the moment that is shown. */
import uPlot from "uplot";
import { h, text } from "../dom";
import { fixed, short } from "../format";
import { colour } from "../theme";
import { digitsOf, shown, unitOf } from "../units";
import { AT_LIMIT, SINGULAR } from "./columns";
import { linesOf, type Kind, type Line } from "./kinds";
import type { Together } from "./together";

const HEIGHT = 138;
/** Below the largest value a logarithmic plot ends. */
const DECADES = 6;
const COLOURS = ["c-velocity", "c-lost", "c-reciprocal", "c-principal", "c-active-force", "c-angular", "ink"];
export const MARKS = [
  { mark: SINGULAR, name: "singular", colour: "c-lost", words: "a singular value is lost" },
  { mark: AT_LIMIT, name: "limit", colour: "c-axes", words: "a limit bounds a joint" },
];
const STRIPE = 4;
/** Of an axis whose numbers have their unit (pixels). */
const WITH_UNIT = 70;
/** Dashes and gaps of a line (pixels): lines beyond the colours and thresholds are dashed, those of models beside the first dotted. */
const DASHES = { solid: [], dashed: [5, 3], dotted: [2, 3] };
export type Style = keyof typeof DASHES;

type Figure = { line: Line; value: HTMLElement };

export class Chart {
  readonly element: HTMLElement;
  private readonly host = h("div", { class: "chart", role: "img", hidden: true });
  private readonly legend = h("div", { class: "chart-legend" });
  private readonly note = h("span", { class: "note" });
  private readonly now = h("div", { class: "chart-now" });
  private plot: uPlot | null = null;
  private figures: Figure[] = [];
  private stretches: [number, number][][] = [];
  private built = "";
  private time = 0;
  private all: Together | null = null;

  constructor(readonly kind: Kind, private readonly seek: (time: number) => void) {
    this.host.setAttribute("aria-label", kind.title);
    this.element = h("figure", { "data-plot": kind.name }, h("figcaption", {}, h("b", {}, kind.title), " ", this.note), this.host, this.legend);
  }

  /** All of a recording; what is there is drawn anew. */
  show(all: Together): void {
    const { kept: lines, of } = linesOf(this.kind, all.models);
    const data = dataOf(all, lines);
    this.all = all;
    const present = lines.filter((_, i) => data[i + 1]?.some((value) => value !== null));
    const units = [...new Set(lines.map((line) => this.unit(line)))].filter(Boolean);
    const remarks = new Set(all.models.map(({ recording }) => this.kind.remark?.(recording)));
    const words = [units.length > 0 && `[${units.join(", ")}]`, ...remarks, lines.length < of && `${lines.length} of ${of}, those that move most`];
    text(this.note, present.length === 0 ? this.kind.none : words.filter(Boolean).join(" "));
    this.host.hidden = this.legend.hidden = present.length === 0;
    const width = this.element.clientWidth;
    if (present.length === 0 || width === 0) return;
    const [first] = all.models;
    this.stretches = MARKS.map(({ mark }) => first?.recording.columns.stretches(mark) ?? []);
    const built = JSON.stringify([lines.map((line) => [line.label, this.unit(line)]), getComputedStyle(document.documentElement).colorScheme]);
    if (this.plot && built === this.built) {
      if (this.plot.width !== width) this.plot.setSize({ width, height: HEIGHT });
      this.figures.forEach((figure, i) => (figure.line = lines[i] ?? figure.line));
      this.plot.setData(data);
    } else {
      this.built = built;
      this.build(lines, data, width);
    }
    this.host.setAttribute("aria-label", `${this.kind.title} over ${fixed(all.times.at(-1) ?? 0, 2)} s, ${lines.length} lines; the values at the time shown are below`);
  }

  /** The values and the place of a moment: of the first model at a sample, of the others at a row of all times. */
  at(index: number, time: number, row: number): void {
    this.time = time;
    for (const { line, value } of this.figures) {
      const sample = line.model === 0 ? index : this.all?.models[line.model]?.samples[row] ?? -1;
      text(value, this.words(line, line.column.at(sample)));
    }
    if (this.plot) this.now.style.transform = `translateX(${this.plot.valToPos(time, "x").toFixed(1)}px)`;
  }

  /** The picture of the plot, null where it has none. */
  get canvas(): HTMLCanvasElement | null {
    return this.host.hidden ? null : this.plot?.ctx.canvas ?? null;
  }

  /** Lines in the order of the legend, for pictures. */
  get entries(): { label: string; colour: string; style: Style }[] {
    return this.figures.map(({ line }) => ({ label: line.label, colour: colour(colourOf(line)), style: styleOf(line) }));
  }

  destroy(): void {
    this.plot?.destroy();
    this.plot = null;
    this.element.remove();
  }

  private unit(line: Line): string {
    const unit = unitOf(line.quantity);
    return unit && unit + this.kind.per;
  }

  private words(line: Line, value: number): string {
    return this.kind.logarithmic ? short(value) : fixed(shown(value, line.quantity), digitsOf(line.quantity, 4));
  }

  private build(lines: Line[], data: uPlot.AlignedData, width: number): void {
    this.plot?.destroy();
    const units = [...new Set(lines.map((line) => this.unit(line)))];
    const stepped = uPlot.paths.stepped?.({ align: 1 });
    const axis = { stroke: () => colour("ink-2"), grid: { stroke: () => colour("line"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const log = this.kind.logarithmic;
    const plot: uPlot = new uPlot({
      width, height: HEIGHT,
      legend: { show: false }, cursor: { show: false },
      padding: [2 * STRIPE + 3, units.length > 1 ? 0 : 10, 0, 0],
      scales: { x: { time: false }, ...Object.fromEntries(units.map((unit) => [scaleOf(unit), log ? { distr: 3, range: decades } : { range: room }])) },
      axes: [
        { ...axis, size: 22, gap: 2, values: (_, all) => all.map((value) => `${short(value, 6)} s`) },
        ...units.map((unit, i): uPlot.Axis => ({
          ...axis, scale: scaleOf(unit), side: i === 0 ? 3 : 1, size: units.length > 1 ? WITH_UNIT : 52, gap: 3,
          grid: i === 0 ? { ...axis.grid, ...(log ? { filter: powers } : {}) } : { show: false },
          ...(log ? { filter: powers } : {}),
          values: (_, all) => all.map((value) => (value === null ? "" : `${log ? power(value) : short(value, 6)}${units.length > 1 ? ` ${unit}` : ""}`)),
        })),
      ],
      series: [
        {},
        ...lines.map((line): uPlot.Series => ({
          label: line.label, scale: scaleOf(this.unit(line)), width: 1.5, points: { show: false }, spanGaps: false,
          stroke: () => colour(colourOf(line)), dash: DASHES[styleOf(line)],
          ...(stepped ? { paths: stepped } : {}),
        })),
      ],
      hooks: { drawAxes: [(drawn) => this.marks(drawn)], setSize: [() => this.place()], setScale: [() => this.place()] },
    }, data, this.host);
    this.plot = plot;
    plot.over.append(this.now);
    const seek = (event: PointerEvent): void => this.seek(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"));
    plot.over.addEventListener("pointerdown", (event) => {
      plot.over.setPointerCapture(event.pointerId);
      seek(event);
    });
    plot.over.addEventListener("pointermove", (event) => {
      if (plot.over.hasPointerCapture(event.pointerId)) seek(event);
    });
    this.figures = lines.map((line) => ({ line, value: h("span", { class: "number" }) }));
    this.legend.replaceChildren(...this.figures.map(({ line, value }) => {
      const swatch = h("span", { class: `stroke ${styleOf(line)}` });
      swatch.style.setProperty("--swatch", `var(--${colourOf(line)})`);
      return h("span", { class: "chart-entry", "data-line": line.label }, swatch, line.label, " ", value);
    }));
  }

  private place(): void {
    if (this.plot) this.now.style.transform = `translateX(${this.plot.valToPos(this.time, "x").toFixed(1)}px)`;
  }

  /** Stripes above the plot. */
  private marks({ ctx, bbox, valToPos }: uPlot): void {
    const ratio = devicePixelRatio;
    this.stretches.forEach((all, row) => {
      ctx.fillStyle = colour(MARKS[row]?.colour ?? "ink");
      for (const [from, to] of all) {
        const [left, right] = [valToPos(from, "x", true), valToPos(to, "x", true)];
        ctx.fillRect(left, bbox.top - (2 - row) * (STRIPE + 1) * ratio, Math.max(right - left, 2 * ratio), STRIPE * ratio);
      }
    });
  }
}

function styleOf({ model, rank, isThreshold }: Line): Style {
  if (model > 0) return "dotted";
  return rank >= COLOURS.length || isThreshold ? "dashed" : "solid";
}

/** The first two models have the same colours, so that a copy is compared with its like. */
function colourOf({ model, rank }: Line): string {
  return COLOURS[(rank + Math.max(model - 1, 0)) % COLOURS.length] ?? "ink";
}

function scaleOf(unit: string): string {
  return unit || "number";
}

/** A little more than the values, and never nothing. */
function room(_: uPlot, low: number | null, high: number | null): uPlot.Range.MinMax {
  const [from, to] = [low ?? 0, high ?? 1];
  const more = Math.max(0.06 * (to - from), 1e-9 + 1e-3 * Math.abs(to));
  return [from - more, to + more];
}

function decades(_: uPlot, low: number | null, high: number | null): uPlot.Range.MinMax {
  const top = Math.ceil(Math.log10(high && high > 0 ? high : 1) + 1e-9);
  const bottom = Math.floor(Math.log10(Math.max(low ?? 0, 10 ** (top - DECADES))));
  return [10 ** Math.min(bottom, top - 1), 10 ** top];
}

function power(value: number): string {
  const exponent = Math.round(Math.log10(value));
  return Math.abs(exponent) > 3 ? `1e${String(exponent).replace("-", "−")}` : short(value);
}

/** Of the places on a logarithmic axis the powers of ten. */
function powers(_: uPlot, places: number[]): (number | null)[] {
  return places.map((place) => (Math.abs(Math.log10(place) - Math.round(Math.log10(place))) < 1e-9 ? place : null));
}

function dataOf({ times, models }: Together, lines: Line[]): uPlot.AlignedData {
  const values = lines.map(({ column, quantity, model }) => {
    const scale = shown(1, quantity);
    return Array.from(models[model]?.samples ?? [], (sample) => {
      const value = column.at(sample);
      return Number.isNaN(value) ? null : value * scale;
    });
  });
  return [Array.from(times), ...values];
}
