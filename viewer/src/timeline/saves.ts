/** Buttons that save a recording: its numbers, its plots, its pictures, and a page that plays it. */
import { h, text } from "../dom";
import { download } from "../download";
import type { Look } from "../film/film";
import { filmPage } from "../film/page";
import { icon } from "../icons";
import { csvOf } from "./csv";
import { frameTimes, MOST_FRAMES, zipped } from "./frames";
import type { Recording } from "./recording";

type Source = {
  recording: () => Recording | null;
  plots: () => Promise<Blob>;
  look: () => Look;
  /** Shows a time; false where another is wanted meanwhile. */
  show: (time: number) => Promise<boolean>;
  picture: () => Promise<Blob>;
  say: (words: string, bad?: boolean) => void;
};

/** Frames of a second. */
const RATE = { least: 1, most: 120, first: 30 };

export class Saves {
  private readonly rate = h("input", { type: "number", class: "field", min: RATE.least, max: RATE.most, step: "any", value: RATE.first, "aria-label": "Frames per second", title: "Frames per second" });
  private readonly words = h("span", {}, "frames");
  private readonly frames = this.button("frames as a zip of numbered PNG", this.words, () => void this.saveFrames());
  /** Those of the group of buttons, and the rate after it. */
  readonly elements: HTMLElement[];
  readonly after: HTMLElement;
  private stopped = true;

  constructor(private readonly source: Source) {
    this.elements = [
      this.button("the recording as JSON", "JSON", () => this.save("json", async (recording) => recording.json())),
      this.button("the recording as CSV", "CSV", () => this.save("csv", async (recording) => csvOf(recording))),
      this.button("the plots as PNG", "PNG", () => this.save("png", () => source.plots(), "-plots")),
      this.button("HTML that plays the recording by itself", "HTML", () => this.save("html", (recording) => filmPage(recording, source.look()))),
    ];
    this.after = h("span", { class: "group", role: "group", "aria-label": "Pictures" }, this.frames, h("label", { class: "note rate" }, this.rate, " per s"));
  }

  private button(what: string, words: string | HTMLElement, action: () => void): HTMLButtonElement {
    return h("button", { class: "button small", type: "button", onclick: action, "aria-label": `Save ${what}`, title: `Save ${what}` }, icon("save"), words);
  }

  private save(ending: string, make: (recording: Recording) => Promise<Blob>, suffix = ""): void {
    const recording = this.source.recording();
    if (!recording) return;
    make(recording).then(
      (blob) => download(blob, `${recording.scene.name}${suffix}.${ending}`),
      (error: unknown) => this.source.say(`The file could not be saved: ${error instanceof Error ? error.message : String(error)}.`, true),
    );
  }

  /** A second press ends it. */
  private async saveFrames(): Promise<void> {
    if (!this.stopped) {
      this.stopped = true;
      return;
    }
    const recording = this.source.recording();
    const rate = this.rate.valueAsNumber;
    if (!recording) return;
    if (!(rate >= RATE.least && rate <= RATE.most)) {
      this.source.say(`Frames per second are a number from ${RATE.least} to ${RATE.most}.`, true);
      return;
    }
    const times = frameTimes(recording.end, rate);
    if (times.length > MOST_FRAMES) {
      this.source.say(`${times.length} frames are more than ${MOST_FRAMES}: choose fewer per second.`, true);
      return;
    }
    this.stopped = false;
    const { name } = recording.scene;
    try {
      const zip = await zipped(name, times, async (time, i) => {
        text(this.words, `${i + 1} of ${times.length}`);
        // Whoever shows something else meanwhile ends it.
        if (this.stopped || !(await this.source.show(time))) return null;
        return this.source.picture();
      });
      if (zip) download(zip, `${name}-frames.zip`);
      else this.source.say("The pictures were not saved: something else was shown meanwhile.");
    } catch (error) {
      this.source.say(`The pictures could not be saved: ${error instanceof Error ? error.message : String(error)}.`, true);
    }
    this.stopped = true;
    text(this.words, "frames");
  }
}
