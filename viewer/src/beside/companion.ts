/** A second model in the view, with a session of its own: where it stands, its joints, and whether one sees through it. */
import { Box3, Group, Mesh, type Material } from "three";
import { Joints } from "../controls/joints";
import { PoseFields } from "../controls/pose_fields";
import { h, text } from "../dom";
import { panel } from "../panels/panel";
import type { Pose, Scene, State } from "../protocol";
import { Robot } from "../robot/robot";
import { setPose } from "../robot/skeleton";
import { glass } from "../scene/palette";
import { Session } from "../session";

type Told = {
  /** Something is to be drawn. */
  changed: () => void;
  say: (words: string, bad?: boolean) => void;
  /** Where it is to stand at first, beside what is there; its box is that at the origin. */
  place: (box: Box3) => Pose;
  remove: () => void;
};

export class Companion {
  readonly group = new Group();
  readonly element: HTMLElement;
  readonly session: Session;
  private readonly robot: Robot;
  private readonly joints: Joints;
  private readonly name = h("b", {}, "…");
  private readonly fields: PoseFields;
  private readonly ghost = h("input", { type: "checkbox", class: "switch", role: "switch" });
  private readonly paints = new Map<Mesh, Material | Material[]>();
  private bodies = "";
  private isPlaced = false;

  /** `url` is that of the sessions of its model. */
  constructor(number: number, url: string, private readonly tell: Told) {
    this.session = new Session(url, tell.changed);
    this.robot = new Robot({ changed: () => this.paint(), problems: ([first]) => first !== undefined && tell.say(`A shape is missing and drawn as rods. ${first}`, true) });
    this.group.add(this.robot.group);
    this.joints = new Joints(this.session, panel(`beside-${number}`, "Joints", false));
    this.fields = new PoseFields(
      { label: (part) => `${part} of the model beside, ${number}`, mark: (part) => ({ "data-beside": part }), orientation: true },
      (pose) => this.stand(pose),
    );
    this.ghost.addEventListener("change", () => this.paint());
    this.element = h(
      "div", { class: "companion", role: "group", "aria-label": `Model beside, ${number}` },
      h("div", { class: "row" }, this.name, h("button", { class: "button small remove", type: "button", "aria-label": `Remove the model beside, ${number}`, title: "Remove", onclick: () => tell.remove() }, "×")),
      h("label", { class: "row" }, this.ghost, h("span", {}, "Transparent")),
      this.fields.element,
      this.joints.panel.element,
    );
    this.session.on("scene", (scene) => this.build(scene));
    this.session.on("state", (state) => this.place(state));
    this.session.on("failure", ({ message, place }) => {
      tell.say(message, true);
      // A model that is gone comes back under another number, if ever.
      if (place === "model") tell.remove();
    });
    this.joints.panel.onToggle(() => this.session.state && this.joints.show(this.session.state));
  }

  close(): void {
    this.session.close();
    this.group.removeFromParent();
    this.element.remove();
  }

  private build(scene: Scene): void {
    text(this.name, scene.name);
    const bodies = JSON.stringify([scene.name, scene.links, scene.joints, scene.loops, scene.contacts]);
    if (bodies !== this.bodies) {
      this.paints.clear();
      this.robot.build(scene);
    }
    this.bodies = bodies;
    this.joints.build(scene);
    this.tell.changed();
  }

  private place(state: State): void {
    this.robot.place(state);
    this.joints.show(state);
    if (!this.isPlaced) this.stand(this.tell.place(this.robot.box()));
    this.isPlaced = true;
    this.tell.changed();
  }

  private stand(pose: Pose): void {
    this.fields.show(pose);
    setPose(this.group, pose);
    this.tell.changed();
  }

  /** Bodies come one after the other. */
  private paint(): void {
    const glassy = glass("c-ghost", 0.35);
    this.robot.group.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      const own = this.paints.get(part) ?? part.material;
      this.paints.set(part, own);
      part.material = this.ghost.checked ? glassy : own;
    });
    this.tell.changed();
  }
}
