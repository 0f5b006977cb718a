/** Buttons that save a recording: its numbers, its plots, its pictures, and a page that plays it. */
import { h, text } from "../dom";
import { download } from "../download";
import type { Look } from "../film/film";
import { filmPage } from "../film/page";
import { fixed } from "../format";
import { icon } from "../icons";
import { csvOf } from "./csv";
import { frameTimes, MOST_FRAMES, zipped } from "./frames";
import type { Recording } from "./recording";
import { filmed, hasVideo, type Paint } from "./video";

/** What is seen of the robot: as a picture, painted elsewhere, and how large it is (pixels). */
export type View = { picture: () => Promise<Blob>; paint: Paint; size: () => { width: number; height: number } };

type Source = {
  recording: () => Recording | null;
  plots: () => Promise<Blob>;
  look: () => Look;
  /** Shows a time; false where another is wanted meanwhile. */
  show: (time: number) => Promise<boolean>;
  view: View;
  say: (words: string, bad?: boolean) => void;
};

/** What is made of many pictures: its name, also on its button. */
type Maker = { name: string; words: HTMLElement };

/** Frames of a second. */
const RATE = { least: 1, most: 120, first: 30 };

export class Saves {
  private readonly rate = h("input", { type: "number", class: "field", min: RATE.least, max: RATE.most, step: "any", value: RATE.first, "aria-label": "Frames per second", title: "Frames per second" });
  private readonly frames = maker("frames");
  private readonly video = maker("video");
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
    this.after = h(
      "span", { class: "pictures", role: "group", "aria-label": "Pictures" },
      h(
        "span", { class: "group" },
        this.button("frames as a zip of numbered PNG", this.frames.words, () => void this.saveFrames()),
        hasVideo() && this.button("a video (WebM)", this.video.words, () => void this.saveVideo()),
      ),
      h("label", { class: "note rate" }, this.rate, " per s"),
    );
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

  private saveFrames(): Promise<void> {
    return this.make(this.frames, async ({ scene: { name }, end }, rate, show) => {
      const times = frameTimes(end, rate);
      if (times.length > MOST_FRAMES) throw new Error(`${times.length} frames are more than ${MOST_FRAMES}: choose fewer per second`);
      const zip = await zipped(name, times, async (time, i) => ((await show(time, `${i + 1} of ${times.length}`)) ? this.source.view.picture() : null));
      return zip && { blob: zip, name: `${name}-frames.zip` };
    });
  }

  private saveVideo(): Promise<void> {
    return this.make(this.video, async ({ scene: { name }, end }, rate, show) => {
      const { paint, size } = this.source.view;
      const { width, height } = size();
      const times = frameTimes(end, rate);
      // The video ends where the recording does, to the milliseconds of its file.
      if (end - (times.at(-1) ?? 0) > 1e-3) times.push(end);
      const video = await filmed({ times, rate, width, height }, (time) => show(time, `${fixed(time, 1)} of ${fixed(end, 1)} s`), paint);
      return video && { blob: video, name: `${name}.webm` };
    });
  }

  /** Shows one time after the other; a second press ends it. */
  private async make({ words, name }: Maker, work: (recording: Recording, rate: number, show: (time: number, words: string) => Promise<boolean>) => Promise<{ blob: Blob; name: string } | null>): Promise<void> {
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
    this.stopped = false;
    try {
      const made = await work(recording, rate, async (time, progress) => {
        text(words, progress);
        // Whoever shows something else meanwhile ends it.
        return !this.stopped && this.source.show(time);
      });
      if (made) download(made.blob, made.name);
      else this.source.say(`No ${name} saved: saving was ended, or something else was shown meanwhile.`);
    } catch (error) {
      this.source.say(`Saving the ${name} failed: ${error instanceof Error ? error.message : String(error)}.`, true);
    }
    this.stopped = true;
    text(words, name);
  }
}

function maker(name: string): Maker {
  return { name, words: h("span", {}, name) };
}
