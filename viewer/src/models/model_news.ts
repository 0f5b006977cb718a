/** What happens to the file of the model: a newer version that is shown, or what is wrong with it. */
import { fill, h } from "../dom";
import type { ModelNews, Refusal } from "../protocol";
import type { Session } from "../session";
import { refusal } from "./refusal";

type Told = {
  /** The scene that comes next is of another version. */
  reloaded: () => void;
  say: (words: string, bad?: boolean, key?: string) => void;
};

export class News {
  private reloads: number | null = null;

  constructor(private readonly element: HTMLElement, session: Session, private readonly tell: Told) {
    session.on("model", (news) => this.take(news));
    session.on("link", ({ link }) => {
      if (link === "open") return;
      // What the next server says is of its own model.
      this.reloads = null;
      element.hidden = true;
    });
    session.on("scene", () => (this.reloads ??= 0));
  }

  private take({ reloads, problem }: ModelNews): void {
    // Whoever comes later has the newest version from the beginning.
    const isNew = this.reloads !== null && reloads > this.reloads;
    this.reloads = reloads;
    if (isNew) {
      this.tell.reloaded();
      this.tell.say("The file of the model has changed; its new version is shown.", false, "model");
    }
    this.element.hidden = problem === null;
    if (problem) fill(this.element, problemOf(problem), h("button", { class: "button small", type: "button", "aria-label": "Close", onclick: () => this.close() }, "×"));
  }

  private close(): void {
    this.element.hidden = true;
    document.querySelector("canvas")?.focus();
  }
}

function problemOf(problem: Refusal): HTMLElement {
  return h("div", { class: "problem" }, h("b", {}, "The file of the model has a fault; the version before it is shown."), ...refusal(problem));
}
