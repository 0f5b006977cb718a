/** Who drives a session that several pages share: words in the bar, and a button that takes over. */
import { h, text } from "../dom";
import { count } from "../format";
import type { About } from "../protocol";
import type { Session } from "../session";

export class Role {
  private readonly words = h("span", { class: "note role", role: "status" });
  private readonly button: HTMLButtonElement;
  private readonly element: HTMLElement;

  constructor(before: HTMLElement, private readonly session: Session) {
    this.button = h("button", { class: "button", type: "button", "data-role": "drive", onclick: () => this.drive() }, "Take over");
    this.element = h("span", { class: "shared", hidden: true }, this.words, this.button);
    before.before(this.element);
    session.on("about", (about) => this.show(about));
  }

  private show({ name, clients, driver, program }: About): void {
    const pages = count(clients, "page");
    // One page of a program drives without saying so.
    this.element.hidden = program && clients === 1 && driver === "you";
    const role = { you: "Driving", another: "Observing", nobody: "Nobody drives" }[driver];
    text(this.words, `${role}, ${pages}`);
    this.words.title = name === null ? "" : `Session ${name}`;
    const label = driver === "you" ? "Release" : driver === "another" ? "Take over" : "Drive";
    text(this.button, label);
    this.button.title = { you: "Let another page drive", another: "Drive instead of the other page", nobody: "Drive the robot" }[driver];
  }

  private drive(): void {
    this.session.send({ type: "drive", on: !this.session.drives });
  }
}
