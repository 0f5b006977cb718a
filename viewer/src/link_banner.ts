/** Says plainly when the server is gone, and when it is tried again. */
import type { Link } from "./connection";
import { fill, h, text } from "./dom";

export class LinkBanner {
  private timer = 0;
  private readonly words = h("span", { class: "note" });

  constructor(private readonly element: HTMLElement, retry: () => void) {
    fill(
      element,
      h("div", {}, h("b", {}, "The server has stopped."), h("br", {}), this.words),
      h("button", { class: "button small", type: "button", onclick: retry }, "Reconnect now"),
    );
  }

  show(link: Link, wait: number): void {
    clearInterval(this.timer);
    this.element.hidden = link !== "lost";
    if (link !== "lost") return;
    const end = performance.now() + wait * 1000;
    const tell = (): void => {
      const left = Math.max(0, Math.ceil((end - performance.now()) / 1000));
      text(this.words, left > 0 ? `The last state is shown. Reconnecting in ${left} s.` : "The last state is shown. Reconnecting…");
    };
    tell();
    this.timer = window.setInterval(tell, 500);
  }
}
