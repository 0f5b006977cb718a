/**
 * Models that are shown beside the first. Which, where and in which sessions is said by the session of the first, for
 * all its pages; the address of a page names them, so that it shows them again in a session of its own.
 */
import { Box3, Group, Vector3 } from "three";
import { h } from "../dom";
import type { KeptModels } from "../models/kept_models";
import { panel } from "../panels/panel";
import type { ModelBeside, Pose, Scene } from "../protocol";
import type { Session } from "../session";
import type { Past, Recording } from "../timeline/recording";
import { Companion } from "./companion";
import { Recorded } from "./recorded";

const PARAMETER = "beside";
/** In the address, for the model of the command. */
const COMMAND = "command";
/** Room between models, as a share of their sizes. */
const ROOM = 0.2;
const MOST = 8;
/** The server gives quaternions the length one. */
const ROUNDING = 1e-9;

type Told = {
  changed: () => void;
  say: (words: string, bad?: boolean) => void;
  /** Of the first model. */
  box: () => Box3;
  /** The user moves one of them. */
  acted: () => void;
  /** What is recorded of one of them is longer. */
  recorded: () => void;
};

export class Companions {
  readonly panel = panel("beside", "Beside", true);
  readonly group = new Group();
  /** By their sessions. */
  private readonly all = new Map<string, Companion>();
  private readonly list = h("div", {});
  private count = 0;
  /** Those of the address, until the first scene. */
  private asked = new URL(location.href).searchParams.getAll(PARAMETER).slice(0, MOST);
  /** What was sent; scenes before the answer do not have it. */
  private sent: { id: number; models: ModelBeside[] } | null = null;
  private recording: Recording | null = null;
  private past: Past | null = null;
  /** Those of a recording that are shown no longer. */
  private readonly gone: Recorded;

  constructor(private readonly main: Session, private readonly models: KeptModels, private readonly tell: Told) {
    this.panel.body.append(h("p", { class: "note" }, "Each of these models has a session of its own here. Open it in a window of its own to drag its target."), this.list);
    this.panel.element.hidden = true;
    this.gone = new Recorded(tell.changed, (session) => this.all.has(session));
    this.group.add(this.gone.group);
    main.on("about", () => {
      const { drives } = main;
      this.panel.body.inert = !drives;
      // What has no place yet gets none.
      if (!drives) this.dropAll(({ isPlaced }) => !isPlaced);
      for (const companion of this.all.values()) companion.drive(drives);
    });
    main.on("link", ({ link }) => {
      if (link === "lost") this.sent = null;
      if (link === "open") for (const { session } of this.all.values()) session.retry();
    });
    main.on("failure", ({ reply_to }) => {
      if (this.sent === null || reply_to !== this.sent.id) return;
      this.sent = null;
      if (main.scene) this.build(main.scene);
    });
  }

  /** Shows a model beside the first: one that the server has opened, or null for that of the command. */
  add(id: string | null): void {
    if (!this.main.drives) {
      this.tell.say("Only the page that drives shows models beside the first.", true);
      return;
    }
    if (this.all.size >= MOST) {
      this.tell.say(`${MOST} models are shown beside the first; remove one of them.`, true);
      return;
    }
    this.begin(newName(), id);
    this.show();
    this.panel.element.open = true;
  }

  /** A new session, which this page drives: it gets the models that the page shows or its address names. */
  restore(): void {
    for (const companion of this.all.values()) companion.bringBack();
    for (const id of this.asked.splice(0)) this.begin(newName(), id === COMMAND ? null : id);
    if ([...this.all.values()].some(({ isPlaced }) => isPlaced)) this.send();
  }

  /** Those of the session; one that this page has added and not placed yet is not among them. */
  build(scene: Scene): void {
    this.asked = [];
    // What was sent by a page that drives no longer is refused, or others have changed it since.
    if (this.sent !== null && this.main.drives && !areSame(this.sent.models, scene.beside)) return;
    this.sent = null;
    const names = scene.beside.map(({ session }) => session);
    this.dropAll(({ isPlaced, name }) => isPlaced && !names.includes(name));
    for (const { session, model, transparent, ...pose } of scene.beside) (this.all.get(session) ?? this.begin(session, model)).stand(pose, transparent);
    this.show();
  }

  /** With the models in it. */
  within(box: Box3): Box3 {
    for (const { group } of this.all.values()) if (group.visible) box.union(new Box3().setFromObject(group));
    return this.gone.within(box);
  }

  /** Before each drawing. */
  takeNewest(): void {
    for (const { session } of this.all.values()) session.takeNewest();
  }

  /** Records them with the first model, or no longer. */
  record(recording: Recording | null): void {
    this.recording = recording;
    for (const companion of this.all.values()) companion.record(recording);
  }

  /** As they were in a recording, or as they are. */
  showPast(past: Past | null): void {
    this.past = past;
    for (const companion of this.all.values()) companion.show(past);
    this.gone.show(past);
    this.tell.changed();
  }

  private begin(name: string, model: string | null): Companion {
    this.count += 1;
    const companion: Companion = new Companion({ number: this.count, model, name, drives: this.main.drives }, this.models, {
      ...this.tell,
      place: (box) => this.placeFor(box, companion),
      moved: () => this.send(),
      remove: () => {
        this.drop(companion);
        this.show();
        this.send();
        (this.list.querySelector("button") ?? document.querySelector("canvas"))?.focus();
        this.tell.changed();
      },
    });
    this.all.set(name, companion);
    this.group.add(companion.group);
    this.list.append(companion.element);
    companion.record(this.recording);
    this.showPast(this.past);
    return companion;
  }

  private dropAll(which: (companion: Companion) => boolean): void {
    const dropped = [...this.all.values()].filter(which);
    dropped.forEach((companion) => this.drop(companion));
    if (dropped.length > 0) this.show();
  }

  private drop(companion: Companion): void {
    companion.close();
    this.all.delete(companion.name);
    this.showPast(this.past);
  }

  /** Tells the session of those that have their places. */
  private send(): void {
    const models = [...this.all.values()].filter(({ isPlaced }) => isPlaced).map(({ described }) => described);
    const id = this.main.send({ type: "beside", models });
    this.sent = id === null ? null : { id, models };
  }

  /** To the right of all models that stand already. */
  private placeFor(box: Box3, companion: Companion): Pose {
    const there = this.tell.box();
    for (const other of this.all.values()) if (other !== companion) there.union(new Box3().setFromObject(other.group));
    const size = Math.max(there.getSize(new Vector3()).length(), box.getSize(new Vector3()).length());
    return { position: [there.max.x - box.min.x + ROOM * size, 0, 0], quaternion: [1, 0, 0, 0] };
  }

  private show(): void {
    this.panel.element.hidden = this.all.size === 0;
    this.panel.note(`${this.all.size}`);
    const url = new URL(location.href);
    url.searchParams.delete(PARAMETER);
    for (const { model } of this.all.values()) url.searchParams.append(PARAMETER, model ?? COMMAND);
    if (url.href !== location.href) window.history.replaceState(null, "", url.href);
  }
}

function areSame(some: ModelBeside[], others: ModelBeside[]): boolean {
  return some.length === others.length && some.every((one, i) => {
    const other = others[i];
    if (!other || one.session !== other.session || one.transparent !== other.transparent) return false;
    const far = Math.hypot(...one.position.map((x, k) => x - (other.position[k] ?? 0)));
    const along = one.quaternion.reduce((sum, x, k) => sum + x * (other.quaternion[k] ?? 0), 0);
    return far < ROUNDING && Math.abs(along) > (1 - ROUNDING) * Math.hypot(...one.quaternion);
  });
}

/** Of a session that nobody else names. */
function newName(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(8));
  return `beside-${Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}
