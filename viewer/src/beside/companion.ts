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
/** A recording that goes on, and since when (ms). */
export type Recorder = { recording: Recording; since: number };

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
  /** The session that was lost, if this page moved its joints. */
  private last: { begun: number | null; scene: Scene; q: number[] } | null = null;
  private recorder: Recorder | null = null;
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
    session.on("failure", ({ message, place }) => place !== "model" && tell.say(message, true));
    session.on("link", ({ link }) => link === "lost" && this.lose());
    session.on("about", ({ begun }) => {
      this.begun = begun;
      if (this.isFresh) this.drive(this.drives);
      this.restore();
    });
    this.unfollow = model === null ? () => undefined : models.follow(session, model, {
      opens: () => this.drives,
      failed: (words) => {
        tell.say(words, true);
        tell.remove();
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
    // Others have moved it meanwhile.
    if (!on) this.last = null;
    const { about } = this.session;
    if (about && (about.driver === "you") !== on) this.session.send({ type: "drive", on });
  }

  /** Records what comes from now on, or no longer. */
  record(recorder: Recorder | null): void {
    this.recorder = recorder;
    this.session.eager = recorder !== null;
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
      if (this.session.state) this.draw(this.session.state);
      return;
    }
    const stands = past.scene.beside.find(({ session }) => session === this.name);
    const state = past.recording.beside.get(this.name)?.stateBefore(past.time);
    this.group.visible = Boolean(stands && state);
    if (!stands || !state) return;
    this.body.stand(stands, stands.transparent);
    this.draw(state);
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
    if (this.past) this.show(this.past);
    else this.draw(state);
  }

  private draw(state: State): void {
    this.robot.place(state);
    this.joints.show(state);
    this.tell.changed();
  }

  private put(pose: Pose): void {
    this.tell.acted();
    this.stand(pose, this.ghost.checked);
    this.tell.moved();
  }

  private lose(): void {
    if (this.isFresh) return;
    this.isFresh = true;
    const { scene, state } = this.session;
    if (this.drives && scene && state) this.last = { begun: this.begun, scene, q: state.q };
  }

  /** A new session has the joints of the one that was lost. */
  private restore(): void {
    const { last, session } = this;
    const { scene, about } = session;
    if (!last || this.isFresh || !scene || !about || !session.drives) return;
    this.last = null;
    if (about.begun === last.begun || scene.name !== last.scene.name || scene.coordinates.length !== last.q.length) return;
    const names = actuated(last.scene);
    this.isRestoring = true;
    if (String(names) !== String(actuated(scene))) session.send({ type: "actuated", names });
    session.send({ type: "configuration", q: last.q });
    this.isRestoring = false;
  }

  private begin(scene: Scene, state: State, age: number): void {
    if (!this.recorder) return;
    const { recording, since } = this.recorder;
    const track = new Recording(scene);
    track.begin(state, age, (performance.now() - since) / 1000);
    recording.beside.set(this.name, track);
  }

  /** What comes is of this scene; a recording of other joints ends. */
  private changeTrack(scene: Scene): void {
    const tracks = this.recorder?.recording.beside;
    const track = tracks?.get(this.name);
    if (!tracks || !track) return;
    const joints = (of: Scene): string => String(of.coordinates.map(({ name }) => name));
    if (joints(scene) === joints(track.scene)) track.changeScene(scene);
    else tracks.delete(this.name);
  }

  private take(raw: string): void {
    const { scene } = this.session;
    if (!this.recorder || !scene) return;
    const track = this.recorder.recording.beside.get(this.name);
    const state = JSON.parse(raw) as State;
    if (track) track.takeLive(raw, state);
    else this.begin(scene, state, 0);
    this.tell.recorded();
  }
}

function actuated(scene: Scene): string[] {
  return scene.actuators.filter((one) => one.actuated).map(({ name }) => name);
}
