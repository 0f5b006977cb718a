/** The panel with the tree of the model and what is selected in it, and the card that names it over the view. */
import { h, Kept } from "../dom";
import { fixed } from "../format";
import { facts, panel } from "../panels/panel";
import type { Pose, Scene, State } from "../protocol";
import type { Session } from "../session";
import { chosenUnits, digitsOf, inUnits, rollPitchYaw, shown, unitOf } from "../units";
import { toolOf, type Item } from "./items";
import type { Selection } from "./selection";
import { Tree } from "./tree";

export class ModelPanel {
  readonly panel = panel("model", "Model", false);
  /** Names what is selected, over the view. */
  readonly card = h("div", { class: "card", role: "group", "aria-label": "Selected", hidden: true });
  private readonly tree: Tree;
  private readonly details = h("div", { class: "tree-details" });
  private readonly keptDetails = new Kept(this.details);
  private readonly keptCard = new Kept(this.card);
  private pose: { element: HTMLElement; set: (i: number, value: string) => void } | null = null;
  /** What was brought into sight last: what is merely marked moves nothing. */
  private revealed: string | null = null;
  private scene: Scene | null = null;
  private state: State | null = null;

  constructor(private readonly session: Session, private readonly selection: Selection) {
    this.tree = new Tree({ select: (key) => selection.select(key), hover: (key) => selection.hover(key) });
    this.panel.body.append(this.tree.element, this.details);
    this.panel.onToggle((open) => {
      if (open) this.show(true);
      else selection.hover(null);
    });
    selection.onChange((byPicking) => this.show(byPicking || selection.selected?.key !== this.revealed));
    inUnits(this.panel.body, () => this.show(false));
    addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !event.defaultPrevented) selection.select(null);
    });
  }

  build(scene: Scene, isNew: boolean): void {
    this.scene = scene;
    const { links, joints, frames } = scene;
    this.panel.note(`${links.length} links, ${joints.length + scene.loops.length} joints, ${frames.length} frames`);
    if (isNew) this.tree.build(this.selection.all);
    this.show(false);
  }

  place(state: State): void {
    this.state = state;
    const { selected } = this.selection;
    const pose = selected?.kind === "link" ? state.links[selected.index] : selected?.pose;
    if (!pose || !this.pose || !this.panel.isOpen()) return;
    values(pose).forEach((value, i) => this.pose?.set(i, value));
  }

  /** Of the selection; `reveal`: it comes into sight. */
  private show(reveal: boolean): void {
    const { scene, selection: { selected } } = this;
    if (!scene) return;
    const tool = selected && toolOf(selected, scene);
    const made = [selected?.key, selected?.words, tool, scene.frame, this.session.drives];
    this.card.hidden = selected === null;
    this.keptCard.fill(made, () => (selected ? this.cardOf(selected, tool) : []));
    if (!this.panel.isOpen()) return;
    this.tree.show(selected, scene.frame, reveal);
    this.revealed = selected?.key ?? null;
    this.keptDetails.fill([...made, chosenUnits()], () => this.detailsOf(selected, tool));
    if (this.state) this.place(this.state);
  }

  private cardOf(item: Item, tool: string | null): (Node | null)[] {
    return [
      h("span", { class: "what" }, h("b", {}, item.name), h("span", { class: "note" }, item.words)),
      this.button(tool),
      h("button", { class: "button small", type: "button", "aria-label": "Clear the selection", title: "Clear the selection (Escape)", onclick: () => this.clear() }, "×"),
    ];
  }

  /** Makes the frame the tool; an observer cannot. */
  private button(tool: string | null): HTMLElement | null {
    if (tool === null || !this.scene) return null;
    if (tool === this.scene.frame) return h("span", { class: "badge" }, "tool");
    const title = `Control the frame ${tool}`;
    return h("button", { class: "button small", type: "button", title, disabled: !this.session.drives, onclick: () => this.session.send({ type: "frame", name: tool }) }, "Use as tool");
  }

  private detailsOf(item: Item | null, tool: string | null): (Node | null)[] {
    this.pose = null;
    if (!item) return [h("p", { class: "note" }, "A click in the view or on an item selects it.")];
    const link = this.scene?.links[item.link]?.name ?? "?";
    const title = h("h3", {}, item.name);
    const words = h("p", { class: "note" }, item.words);
    if (!item.pose) return [title, words];
    this.pose = facts(names());
    const frame = { link: "Pose in the world", frame: `Pose in ${link}`, joint: `Joint frame at zero in ${link}`, loop: "" }[item.kind];
    return [title, words, h("h3", {}, frame), this.pose.element, tool === null || tool === this.scene?.frame ? null : h("div", { class: "row" }, this.button(tool))];
  }

  private clear(): void {
    this.selection.select(null);
    document.querySelector("canvas")?.focus();
  }
}

function names(): string[] {
  const { orientation } = chosenUnits();
  const turned = orientation === "quaternion" ? ["qw", "qx", "qy", "qz"] : ["roll", "pitch", "yaw"].map((name) => `${name} [${unitOf("rad")}]`);
  return [...["x", "y", "z"].map((name) => `${name} [${unitOf("m")}]`), ...turned];
}

function values({ position, quaternion }: Pose): string[] {
  const isQuaternion = chosenUnits().orientation === "quaternion";
  const turned = isQuaternion ? quaternion.map((x) => fixed(x, 5)) : rollPitchYaw(quaternion).map((x) => fixed(shown(x, "rad"), digitsOf("rad", 5)));
  return [...position.map((x) => fixed(shown(x, "m"), digitsOf("m", 5))), ...turned];
}
