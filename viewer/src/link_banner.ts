/** Says plainly when the server or its model is gone, and when it is tried again. */
import type { Link } from "./connection";
import { fill, h, text } from "./dom";
import type { Session } from "./session";

export class LinkBanner {
  private timer = 0;
  private readonly title = h("b", {});
  private readonly words = h("span", { class: "note" });

  constructor(private readonly element: HTMLElement, private readonly session: Session) {
    fill(
      element,
      h("div", {}, this.title, h("br", {}), this.words),
      h("button", { class: "button small", type: "button", onclick: () => session.retry() }, "Reconnect now"),
    );
    session.on("link", ({ link, wait }) => this.show(link, wait));
    session.on("scene", () => (element.hidden = true));
  }

  private show(link: Link, wait: number): void {
    clearInterval(this.timer);
    const { isModelGone, state } = this.session;
    // While the model is gone, a line that opens says nothing.
    this.element.hidden = link !== "lost" && !isModelGone;
    if (link !== "lost") return;
    text(this.title, isModelGone ? "The server does not have this model." : "The server has stopped.");
    const end = performance.now() + wait * 1000;
    const tell = (): void => {
      const left = Math.max(0, Math.ceil((end - performance.now()) / 1000));
      text(this.words, `${state ? "The last state is shown. " : ""}${left > 0 ? `Reconnecting in ${left} s.` : "Reconnecting…"}`);
    };
    tell();
    this.timer = window.setInterval(tell, 500);
  }
}
