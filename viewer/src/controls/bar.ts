/** The bar: which model, play and reset, recording, files, picture and address, theme. */
import { fill, h, text } from "../dom";
import { count } from "../format";
import { icon, type Icon } from "../icons";
import type { Scene, State } from "../protocol";
import { nextTheme, onTheme, theme } from "../theme";
import type { Link } from "../connection";

export type BarActions = {
  play: () => void; pause: () => void; reset: () => void; undo: () => void; redo: () => void;
  record: () => void; open: () => void; picture: () => void; share: () => void;
};

function button(label: string, name: Icon, action: () => void, shown = label): HTMLButtonElement {
  return h("button", { class: "button", type: "button", title: label, "aria-label": label, onclick: action }, icon(name), shown && h("span", {}, shown));
}

export class Bar {
  private readonly model = h("div", { class: "model" }, "no model yet");
  /** Says whether the server is there. */
  readonly status = h("span", { class: "status", role: "status" }, "connecting");
  private readonly play: HTMLButtonElement;
  private readonly record: HTMLButtonElement;
  private readonly themeButton = button("Theme", "system", () => nextTheme(), "");
  private readonly reset: HTMLButtonElement;
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private playing = true;

  constructor(bar: HTMLElement, actions: BarActions) {
    this.play = button("Pause", "pause", () => (this.playing ? actions.pause() : actions.play()));
    this.reset = button("Reset", "reset", actions.reset);
    this.undo = button("Undo (Ctrl+Z)", "undo", actions.undo, "");
    this.redo = button("Redo (Ctrl+Shift+Z)", "redo", actions.redo, "");
    this.undoable(false, false);
    this.record = button("Record", "record", actions.record);
    this.record.setAttribute("aria-pressed", "false");
    bar.append(
      h("h1", { class: "brand" }, h("img", { src: "./icon.svg", alt: "" }), "cylindroid"),
      this.model,
      h("div", { class: "spread" }),
      this.play,
      this.reset,
      h("span", { class: "group", role: "group", "aria-label": "History" }, this.undo, this.redo),
      h("span", { class: "rule" }),
      this.record,
      button("Open a file", "open", actions.open, "Open"),
      button("Save a picture as PNG", "picture", actions.picture, "PNG"),
      button("Copy a link to this configuration", "share", actions.share, "Link"),
      this.themeButton,
      this.status,
    );
    onTheme(() => this.paint());
    this.paint();
  }

  build(scene: Scene): void {
    const facts = [
      count(scene.coordinates.length, "coordinate"),
      scene.loops.length > 0 && count(scene.loops.length, "loop"),
      scene.contacts.length > 0 && count(scene.contacts.length, "contact"),
      scene.ignored > 0 && `${scene.ignored} ignored in the file`,
    ].filter(Boolean);
    fill(this.model, h("b", {}, scene.name), ` ${facts.join(", ")}`);
    this.model.title = `${scene.name}: ${facts.join(", ")} (${scene.format})`;
    document.title = `${scene.name} – cylindroid`;
  }

  show(state: State): void {
    if (state.playing === this.playing) return;
    this.playing = state.playing;
    const label = this.playing ? "Pause" : "Play";
    this.play.setAttribute("aria-label", label);
    this.play.title = label;
    fill(this.play, icon(this.playing ? "pause" : "play"), h("span", {}, label));
  }

  /** A disabled button would lose the focus. */
  undoable(undo: boolean, redo: boolean): void {
    this.undo.setAttribute("aria-disabled", String(!undo));
    this.redo.setAttribute("aria-disabled", String(!redo));
  }

  /** An observer cannot move the robot. */
  observe(observes: boolean): void {
    for (const control of [this.play, this.reset, this.undo, this.redo]) control.disabled = observes;
  }

  link(link: Link): void {
    this.status.dataset["state"] = link;
    text(this.status, { open: "connected", connecting: "connecting", lost: "disconnected" }[link]);
  }

  recorded(recording: boolean, states: number): void {
    this.record.setAttribute("aria-pressed", String(recording));
    this.record.classList.toggle("recording", recording);
    const label = recording ? `Stop (${states})` : "Record";
    const words = this.record.querySelector("span");
    if (words) text(words, label);
    this.record.setAttribute("aria-label", recording ? `Stop recording, ${count(states, "state")}` : "Record");
  }

  private paint(): void {
    const now = theme();
    const label = { system: "Theme: system", light: "Theme: light", dark: "Theme: dark" }[now];
    this.themeButton.title = label;
    this.themeButton.setAttribute("aria-label", label);
    fill(this.themeButton, icon(now));
  }
}
