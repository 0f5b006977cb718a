/** The plots of a recording: which are shown, their width, their picture. */
import { h, type Child } from "../dom";
import { panel } from "../panels/panel";
import { colour, onTheme } from "../theme";
import { inUnits } from "../units";
import { Chart } from "./chart";
import { KINDS } from "./kinds";
import type { Recording } from "./recording";

/** While a recording grows it is plotted again after this time (ms). */
const PAUSE = 250;
const SHOWN_FIRST = ["joints", "singular"];

export class Plots {
  readonly panel = panel("plots", "Plots", true);
  private readonly charts = new Map<string, Chart>();
  private readonly list = h("div", { class: "charts" });
  private recording: Recording | null = null;
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
      h("p", { class: "note marks" },
        h("span", { class: "mark singular" }), "a singular value is lost ", h("span", { class: "mark limit" }), "a joint is at a limit"),
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
    this.recording = recording;
    this.draw();
  }

  /** The recording has become longer. */
  grow(): void {
    this.timer ||= window.setTimeout(() => this.draw(), PAUSE);
  }

  at(index: number, time: number): void {
    this.moment = { index, time };
    if (this.panel.isOpen()) for (const chart of this.charts.values()) chart.at(index, time);
  }

  /** All plots that are shown, one below the other. */
  picture(): Promise<Blob> {
    const shown = [...this.charts.values()].flatMap((chart) => (chart.canvas ? [{ chart, canvas: chart.canvas }] : []));
    if (shown.length === 0) return Promise.reject(new Error("no plot is shown"));
    const scale = devicePixelRatio;
    const [title, legend] = [22 * scale, 20 * scale];
    const canvas = document.createElement("canvas");
    canvas.width = Math.max(...shown.map((one) => one.canvas.width));
    canvas.height = shown.reduce((sum, one) => sum + one.canvas.height + title + legend, 0);
    const context = canvas.getContext("2d");
    if (!context) return Promise.reject(new Error("this browser does not support 2D canvases"));
    context.fillStyle = colour("panel");
    context.fillRect(0, 0, canvas.width, canvas.height);
    let y = 0;
    for (const { chart, canvas: drawn } of shown) {
      context.font = `600 ${13 * scale}px system-ui, sans-serif`;
      context.fillStyle = colour("ink");
      context.fillText(chart.element.querySelector("figcaption")?.textContent ?? "", 8 * scale, y + 15 * scale);
      context.drawImage(drawn, 0, y + title);
      context.font = `${11 * scale}px system-ui, sans-serif`;
      let x = 52 * scale;
      for (const { label, colour: ink } of chart.entries) {
        context.fillStyle = ink;
        context.fillRect(x, y + title + drawn.height + 5 * scale, 12 * scale, 3 * scale);
        context.fillStyle = colour("ink");
        context.fillText(label, x + 16 * scale, y + title + drawn.height + 11 * scale);
        x += context.measureText(label).width + 30 * scale;
      }
      y += drawn.height + title + legend;
    }
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
    for (const chart of this.charts.values()) chart.show(this.recording);
    this.at(this.moment.index, this.moment.time);
  }
}
