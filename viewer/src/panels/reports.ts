/** Reports of the library for the panels that are open, asked for when the configuration has changed. */
import type { Report, ReportName } from "../protocol";
import type { Session } from "../session";
import type { Panel } from "./panel";

/** Between two requests of one report (ms). */
const PAUSE = 300;

export type Watch = {
  panel: Panel;
  show: (report: Record<string, unknown>) => void;
  fail: (sentence: string) => void;
};

type Asked = { id: number; isOfThisScene: boolean };

export class Reports {
  private readonly watches = new Map<ReportName, Watch & { stale: boolean }>();
  private readonly asked = new Map<number, ReportName>();
  /** The request of each report that has no answer yet, one at a time: the server refuses more than four. */
  private readonly underWay = new Map<ReportName, Asked>();
  private timer = 0;
  private q = "";

  constructor(private readonly session: Session) {
    session.on("scene", () => {
      for (const request of this.underWay.values()) request.isOfThisScene = false;
      this.stale();
    });
    // What was asked on another line is not answered on this one.
    session.on("link", () => this.underWay.clear());
    session.on("state", (state) => {
      const q = state.q.join();
      if (q === this.q) return;
      this.q = q;
      this.stale();
    });
    session.on("report", (report) => this.take(report));
    session.on("failure", ({ reply_to, message }) => {
      const name = typeof reply_to === "number" ? this.asked.get(reply_to) : undefined;
      if (!name) return;
      if (this.isAwaited(name, reply_to)) this.watches.get(name)?.fail(message);
      this.answered(name, reply_to);
    });
  }

  watch(name: ReportName, watch: Watch): void {
    this.watches.set(name, { ...watch, stale: true });
    watch.panel.onToggle(() => this.later());
  }

  /** Whether an error belongs to a report: panels show those. */
  owns(id: unknown): boolean {
    return typeof id === "number" && this.asked.has(id);
  }

  private stale(): void {
    for (const watch of this.watches.values()) watch.stale = true;
    this.later();
  }

  private later(): void {
    if (this.timer) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.ask();
    }, PAUSE);
  }

  private ask(): void {
    const { scene } = this.session;
    if (!scene) return;
    for (const [name, watch] of this.watches) {
      if (!watch.stale || !watch.panel.isOpen() || this.underWay.has(name)) continue;
      if (!scene.reports.includes(name)) continue;
      const id = this.session.send({ type: "report", name });
      if (id === null) return;
      watch.stale = false;
      this.asked.set(id, name);
      this.underWay.set(name, { id, isOfThisScene: true });
    }
  }

  private take(report: Report): void {
    if (this.isAwaited(report.name, report.reply_to)) this.watches.get(report.name)?.show(report.report);
    if (typeof report.reply_to === "number") this.asked.delete(report.reply_to);
    this.answered(report.name, report.reply_to);
  }

  /** An answer to a question from before this scene may be of another frame or model. */
  private isAwaited(name: ReportName, id: unknown): boolean {
    const request = this.underWay.get(name);
    return request !== undefined && request.id === id && request.isOfThisScene;
  }

  /** What has changed since is asked for now. */
  private answered(name: ReportName, id: unknown): void {
    if (this.underWay.get(name)?.id !== id) return;
    this.underWay.delete(name);
    this.later();
  }
}

/** A field of a report as a number, a list of numbers, words: nothing where it is something else. */
export function numberIn(report: Record<string, unknown>, key: string): number | null {
  const value = report[key];
  return typeof value === "number" ? value : null;
}
export function listIn(report: Record<string, unknown>, key: string): unknown[] {
  const value = report[key];
  return Array.isArray(value) ? value : [];
}
export function objectIn(report: Record<string, unknown>, key: string): Record<string, unknown> {
  const value = report[key];
  return typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Record<string, unknown>) : {};
}
