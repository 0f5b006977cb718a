/** The dialogue that opens files and switches models. */
import { fill, h, type Child } from "../dom";
import { chosen, type Given } from "../files";
import type { Models, Refusal } from "../protocol";
import { ACCEPTED, isMotion, modelFiles, request, type ModelFiles } from "./model_files";
import { refusal } from "./refusal";

const PARAMETER = "model";
/** Shows a model in one way or another, once it is open. */
type Show = (show: (id: string | null) => void) => void;

/** Shows another model: that of the server, or one that it has opened. */
function go(id: string | null): void {
  const url = new URL(location.href);
  url.hash = "";
  // A session of that name is one of another model.
  url.searchParams.delete("session");
  if (id === null) url.searchParams.delete(PARAMETER);
  else url.searchParams.set(PARAMETER, id);
  location.assign(url.href);
}

export class OpenDialog {
  private readonly problem = h("div", { class: "problem", role: "alert" });
  private readonly choice = h("div", { class: "stack" });
  private readonly models = h("div", {});
  private readonly input = h("input", { type: "file", multiple: true, accept: ACCEPTED, hidden: true, "aria-label": "Files to open" });
  private readonly element = h(
    "dialog", { class: "open", "aria-labelledby": "open-title" },
    h("form", { method: "dialog", class: "row" }, h("h2", { id: "open-title" }, "Open"), h("button", { class: "button small", "aria-label": "Close" }, "×")),
    h("div", { class: "row" }, h("button", { class: "button primary", type: "button", onclick: () => this.input.click() }, "Choose files"), this.input),
    h("p", { class: "note" }, "A model: URDF, MJCF, SDF or a mechanism file (.toml), with its meshes in the same choice or all of it in a zip. A motion of the model that is shown, or a map of a sweep: CSV, JSON or Parquet. Files, and folders with a model, can be dropped on the page, too."),
    this.problem, this.choice, this.models,
  );

  /** `motion` shows a motion of the model or a map, `beside` a model beside this one. */
  constructor(private readonly motion: (file: File) => void, private readonly beside: (id: string | null) => void) {
    document.body.append(this.element);
    this.input.addEventListener("change", () => {
      void this.take(chosen(this.input.files ?? []));
      this.input.value = "";
    });
  }

  async show(): Promise<void> {
    this.clear();
    if (!this.element.open) this.element.showModal();
    try {
      const answer = await fetch("./models");
      if (!answer.ok) throw new Error(await answer.text());
      this.list((await answer.json()) as Models);
    } catch (error) {
      this.refuse(`The models of the server cannot be listed: ${words(error)}`);
    }
  }

  /** Files that were chosen or dropped: motions are shown, others are a model. */
  async take(given: Given[]): Promise<void> {
    const motions = given.filter(({ path }) => isMotion(path));
    if (motions.length > 0 && motions.length === given.length) {
      this.element.close();
      for (const { file } of motions) this.motion(file);
      return;
    }
    if (given.length === 0) return;
    this.clear();
    try {
      const found = await modelFiles(given.filter(({ path }) => !isMotion(path)));
      const [first] = found.candidates;
      if (first !== undefined && found.candidates.length === 1) await this.open(first, found.files);
      else this.choose(found);
    } catch (error) {
      this.refuse(words(error));
    }
  }

  private list({ name, catalogue, opened, opens }: Models): void {
    const button = (label: string, show: Show, note: Child): HTMLElement =>
      h(
        "div", { class: "offer" },
        h("button", { class: "button small", type: "button", onclick: () => show(go) }, label),
        h("button", { class: "button small", type: "button", "aria-label": `${label} beside the model that is shown`, title: "Show it beside this model", onclick: () => show((id) => this.stand(id)) }, "+"),
        h("span", { class: "note" }, note),
      );
    if (!opens) this.refuse("This server opens no files and no other models: other machines reach it, or a program holds its session.");
    fill(
      this.models,
      h("h3", {}, "Open on this server"),
      button(name, (show) => show(null), "the model of the command"),
      ...opened.map((model) => button(model.name, (show) => show(model.id), "opened")),
      opens && h("h3", {}, "Catalogue"),
      ...(opens ? catalogue.map((model) => button(model.name, (show) => void this.open(model.name, new Map(), show), model.description)) : []),
    );
  }

  private choose({ candidates, files }: ModelFiles): void {
    if (!this.element.open) void this.show();
    fill(
      this.choice,
      h("h3", {}, "Which of these is the model?"),
      ...candidates.map((path) => h("button", { class: "button small", type: "button", onclick: () => void this.open(path, files) }, path)),
    );
    this.choice.querySelector("button")?.focus();
  }

  private stand(id: string | null): void {
    this.element.close();
    this.beside(id);
  }

  private async open(path: string, files: Map<string, Uint8Array>, show: (id: string) => void = go): Promise<void> {
    try {
      const answer = await fetch("./models", { method: "POST", body: request(path, files) });
      if (answer.ok) show(((await answer.json()) as { id: string }).id);
      else if (answer.headers.get("content-type")?.includes("json")) this.refuse((await answer.json()) as Refusal);
      else this.refuse(await answer.text());
    } catch (error) {
      this.refuse(`The server cannot be reached: ${words(error)}`);
    }
  }

  private clear(): void {
    fill(this.problem);
    fill(this.choice);
  }

  private refuse(why: Refusal | string): void {
    const told = typeof why === "string" ? { message: why, file: null, line: null, column: null, text: null, help: "" } : why;
    if (!this.element.open) this.element.showModal();
    fill(this.problem, ...refusal(told));
  }
}

function words(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
