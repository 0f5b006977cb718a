/** A second model in the view, with a session of its own: where it stands, its joints, and whether one sees through it. */
import type { Box3 } from "three";
import { socketTo } from "../connection";
import { Joints } from "../controls/joints";
import { PoseFields } from "../controls/pose_fields";
import { h, text } from "../dom";
import type { KeptModels } from "../models/kept_models";
import { panel } from "../panels/panel";
import type { ModelBeside, Pose, Scene, State, ToServer } from "../protocol";
import { Session } from "../session";
import { Recording, type Past } from "../timeline/recording";
import { Body } from "./body";

/** Its place among the others, its model, its session, and whether this page moves its joints. */
type Own = { number: number; model: string | null; name: string; drives: boolean };
type Told = {
  /** Something is to be drawn. */
  changed: () => void;
  say: (words: string, bad?: boolean) => void;
  /** Where it is to stand at first, beside what is there; its box is that at the origin. */
  place: (box: Box3) => Pose;
  /** It stands elsewhere, or one sees through it or no longer. */
  moved: () => void;
  /** The user moves it. */
  acted: () => void;
  /** Its recording is longer. */
  recorded: () => void;
  remove: () => void;
};

/** What moves its joints. */
const MOVES: readonly ToServer["type"][] = ["joint", "actuated", "null_space"];

export class Companion {
  readonly element: HTMLElement;
  readonly session: Session;
  readonly name: string;
  readonly model: string | null;
  isPlaced = false;
  private readonly body: Body;
  private readonly joints: Joints;
  private readonly title = h("b", {}, "…");
  private readonly fields: PoseFields;
  private readonly ghost = h("input", { type: "checkbox", class: "switch", role: "switch" });
  private readonly unfollow: () => void;
  private pose: Pose = { position: [0, 0, 0], quaternion: [1, 0, 0, 0] };
  private drives: boolean;
  /** True until the first scene of a connection. */
  private isFresh = true;
  private begun: number | null = null;
  /** Nobody drives it. */
  private isFree = false;
  /** This page restores the session of the first model, and this one with it. */
  private bringsBack = false;
  /** The session that was lost. */
  private last: { begun: number | null; scene: Scene; q: number[] } | null = null;
  /** That of the first model, which goes on. */
  private recording: Recording | null = null;
  /** What is shown in place of the model as it is. */
  private past: Past | null = null;
  private isRestoring = false;

  constructor({ number, model, name, drives }: Own, models: KeptModels, private readonly tell: Told) {
    [this.name, this.model, this.drives] = [name, model, drives];
    this.session = new Session(() => socketTo(model, name, !this.drives), tell.changed);
    this.body = new Body({ changed: tell.changed, problems: ([first]) => first !== undefined && tell.say(`A shape is missing and drawn as rods. ${first}`, true) });
    this.joints = new Joints(this.session, panel(`beside-${number}`, "Joints", false));
    this.fields = new PoseFields(
      { label: (part) => `${part} of the model beside, ${number}`, mark: (part) => ({ "data-beside": part }), orientation: true },
      (pose) => this.put(pose),
    );
    this.ghost.addEventListener("change", () => this.put(this.pose));
    this.element = h(
      "div", { class: "companion", role: "group", "aria-label": `Model beside, ${number}` },
      h("div", { class: "row" }, this.title, h("button", { class: "button small remove", type: "button", "aria-label": `Remove the model beside, ${number}`, title: "Remove", onclick: () => tell.remove() }, "×")),
      h("label", { class: "row" }, this.ghost, h("span", {}, "Transparent")),
      this.fields.element,
      this.joints.panel.element,
    );
    const { session } = this;
    session.on("scene", (scene) => this.build(scene));
    session.on("state", (state) => this.place(state));
    session.on("raw", (raw) => this.take(raw));
    session.on("sending", ({ type }) => MOVES.includes(type) && !this.isRestoring && tell.acted());
    session.on("failure", ({ message, place }) => !["model", "session"].includes(place) && tell.say(message, true));
    session.on("link", ({ link }) => link === "lost" && this.lose());
    session.on("about", ({ begun, driver }) => {
      [this.begun, this.isFree] = [begun, driver === "nobody"];
      if (this.isFresh) this.drive(this.drives);
      this.restore();
    });
    this.unfollow = model === null ? () => undefined : models.follow(session, model, {
      opens: (isKept) => this.drives || (isKept && this.isFree),
      failed: (words, isKept) => {
        tell.say(words, true);
        if (!isKept) tell.remove();
      },
    });
    this.joints.panel.onToggle(() => session.state && !this.past && this.joints.show(session.state));
  }

  get group(): Body["group"] {
    return this.body.group;
  }

  get robot(): Body["robot"] {
    return this.body.robot;
  }

  close(): void {
    this.unfollow();
    this.session.close();
    this.group.removeFromParent();
    this.element.remove();
  }

  /** As the session of the first model has it. */
  get described(): ModelBeside {
    return { model: this.model, session: this.name, ...this.pose, transparent: this.ghost.checked };
  }

  stand({ position, quaternion }: Pose, transparent: boolean): void {
    this.pose = { position, quaternion };
    this.isPlaced = true;
    this.fields.show(this.pose);
    this.ghost.checked = transparent;
    if (!this.past) this.body.stand(this.pose, transparent);
  }

  /** Who moves the first model moves this one. */
  drive(on: boolean): void {
    this.drives = on;
    const { about } = this.session;
    if (about && (about.driver === "you") !== on) this.session.send({ type: "drive", on });
  }

  /** Its session is that of a new server: it gets the joints of the one that was lost. */
  bringBack(): void {
    this.bringsBack = true;
    this.restore();
  }

  /** Records what comes from now on, or no longer. */
  record(recording: Recording | null): void {
    this.recording = recording;
    this.session.eager = recording !== null;
    const { scene, state, age } = this.session;
    if (scene && state) this.begin(scene, state, age);
  }

  /** As it was at a moment of a recording, or as it is. */
  show(past: Past | null): void {
    const was = this.past;
    this.past = past;
    if (!past) {
      if (!was) return;
      this.group.visible = true;
      this.body.stand(this.pose, this.ghost.checked);
      const { scene, state } = this.session;
      if (scene && state) this.draw(scene, state);
      return;
    }
    const stands = past.scene.beside.find(({ session }) => session === this.name);
    const track = past.recording.beside.get(this.name);
    const state = track?.stateBefore(past.time);
    this.group.visible = Boolean(stands && state);
    if (!stands || !track || !state) return;
    this.body.stand(stands, stands.transparent);
    this.draw(track.sceneAt(track.columns.indexAt(past.time)), state);
  }

  private build(scene: Scene): void {
    this.isFresh = false;
    text(this.title, scene.name);
    this.body.build(scene);
    this.joints.build(scene);
    this.changeTrack(scene);
    this.restore();
    this.tell.changed();
  }

  private place(state: State): void {
    if (!this.isPlaced) {
      this.robot.place(state);
      this.stand(this.tell.place(this.robot.box()), this.ghost.checked);
      this.tell.moved();
    }
    const { scene } = this.session;
    if (this.past) this.show(this.past);
    else if (scene) this.draw(scene, state);
  }

  private draw(scene: Scene, state: State): void {
    this.body.build(scene);
    this.robot.place(state);
    if (this.session.scene && areJointsSame(scene, this.session.scene)) this.joints.show(state);
    this.tell.changed();
  }

  private put(pose: Pose): void {
    this.tell.acted();
    this.stand(pose, this.ghost.checked);
    this.tell.moved();
  }

  private lose(): void {
    this.track?.lose();
    if (this.isFresh) return;
    [this.isFresh, this.bringsBack] = [true, false];
    const { scene, state } = this.session;
    if (scene && state) this.last = { begun: this.begun, scene, q: state.q };
  }

  /** A new session has the joints of the one that was lost, unless another page has moved them. */
  private restore(): void {
    const { last, session } = this;
    const { scene, about } = session;
    if (!last || this.isFresh || !scene || !about) return;
    const isNew = about.begun !== last.begun && scene.name === last.scene.name && scene.coordinates.length === last.q.length;
    if (isNew && !session.drives && (this.drives || about.driver === "nobody")) {
      // It goes on once this page drives, which may be for this alone.
      if (about.driver === "nobody" && this.bringsBack) session.send({ type: "drive", on: true });
      return;
    }
    this.last = null;
    if (!isNew || !session.drives) return;
    const names = actuated(last.scene);
    this.isRestoring = true;
    if (String(names) !== String(actuated(scene))) session.send({ type: "actuated", names });
    session.send({ type: "configuration", q: last.q });
    this.isRestoring = false;
    if (!this.drives) session.send({ type: "drive", on: false });
  }

  private begin(scene: Scene, state: State, age: number): void {
    if (!this.recording) return;
    const track = new Recording(scene);
    track.begin(state, age, this.recording.now);
    this.recording.beside.set(this.name, track);
  }

  /** What is recorded of this model. */
  private get track(): Recording | undefined {
    return this.recording?.beside.get(this.name);
  }

  /** What comes is of this scene; a recording of other joints ends. */
  private changeTrack(scene: Scene): void {
    const { track } = this;
    if (!track) return;
    if (areJointsSame(scene, track.scene)) {
      track.changeScene(scene);
      return;
    }
    this.record(null);
    this.tell.say(`${scene.name}, beside the first model, has other joints now: its recording has ended.`);
  }

  private take(raw: string): void {
    const { track, session: { scene } } = this;
    if (!this.recording || !scene) return;
    const state = JSON.parse(raw) as State;
    if (track) track.takeLive(raw, state);
    else this.begin(scene, state, 0);
    this.tell.recorded();
  }
}

function areJointsSame(one: Scene, other: Scene): boolean {
  const joints = ({ coordinates }: Scene): string => String(coordinates.map(({ name }) => name));
  return one === other || joints(one) === joints(other);
}

function actuated(scene: Scene): string[] {
  return scene.actuators.filter((one) => one.actuated).map(({ name }) => name);
}
