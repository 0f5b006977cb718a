/** Brings a session to a configuration: that of the address on load, the last one after the server came back. */
import type { Overlays } from "./overlays/overlays";
import type { About, Driver, Scene, State } from "./protocol";
import type { Stage } from "./scene/stage";
import type { Session } from "./session";
import { parse, snapshot, type Snapshot } from "./share";

/** Within this after a restart the pages of a session come back (ms). */
const RETURNING = 30_000;

export class Restore {
  private wanted: Snapshot | null = null;
  /** The session that was lost; `begun` is null for a page alone. */
  private last: { shot: Snapshot; begun: number | null } | null = null;
  /** Of the session: it is gone when the connection is. */
  private about: About | null = null;
  private fresh = true;
  /** This page drove a session that begins anew under another page, and drives again once that one does not. */
  private drivesAgain = false;
  private drivesUntil = 0;
  /** Who drove when the connection was lost; this page before. */
  drove: Driver = "you";

  constructor(
    private readonly session: Session,
    private readonly overlays: Overlays,
    private readonly stage: Stage,
    private readonly say: (words: string, bad?: boolean) => void,
    /** Called for every connection; `hasBegun`: its session is new, or that of a program that was restarted, and this page drives it. */
    private readonly begin: (hasBegun: boolean) => void,
    /** What is shown: the session, or a moment of a recording. */
    private readonly shown: () => Partial<{ scene: Scene | null; state: State | null }>,
  ) {
    this.read();
    addEventListener("hashchange", () => {
      this.read();
      if (this.session.scene) this.apply(this.session.scene);
      this.camera();
    });
    session.on("about", (about) => {
      this.about = about;
      this.driveAgain(about);
    });
    session.on("link", ({ link }) => {
      if (link !== "lost" || this.fresh) return;
      [this.fresh, this.drivesAgain] = [true, false];
      const { scene, state } = session;
      const { about } = this;
      this.drove = about?.driver ?? "you";
      // The robot as it was, whatever is shown.
      const shot = scene && state && this.shot(scene, state);
      this.last = shot && { shot, begun: about?.begun ?? null };
    });
  }

  /** The configuration as it is. */
  now(): Snapshot | null {
    const { scene, state } = this.shown();
    return scene && state ? this.shot(scene, state) : null;
  }

  private shot(scene: Scene, state: State): Snapshot {
    return snapshot(scene, state, this.overlays.on, this.stage.place(), this.stage.isOrthographic);
  }

  /** The first scene of a connection: the session on the other side is new. True for it. */
  scene(scene: Scene): boolean {
    if (!this.fresh) return false;
    this.fresh = false;
    const { session, last } = this;
    const { about } = session;
    // A session that others hold, or a program, is as they have it; so is one that has gone on meanwhile.
    const isNew = about === null || (!about.program && session.drives && (last ? about.begun !== last.begun : about.clients === 1));
    const isRestored = isNew && last?.shot.model === scene.name;
    if (!isNew) this.wanted = null;
    else if (isRestored) {
      this.wanted = last.shot;
      this.say("The connection is restored, with the previous configuration.");
    }
    this.drivesAgain = about !== null && !about.program && this.drove === "you" && last !== null && about.begun !== last.begun;
    this.drivesUntil = performance.now() + RETURNING;
    this.last = null;
    session.send({ type: "overlays", names: this.overlays.names() });
    // The robot is the program's, what stands beside it is of its pages.
    this.begin(isNew || (session.drives && last !== null && about?.begun !== last.begun));
    this.apply(scene);
    // Whoever drove before drives again.
    if (isRestored && this.drove === "another") session.send({ type: "drive", on: false });
    if (about) this.driveAgain(about);
    return true;
  }

  /** A page that came before this one brings the session back and lets go of it. */
  private driveAgain({ driver }: About): void {
    if (!this.drivesAgain || driver === "another") return;
    // Long after the restart who let go of it has nothing to do with it.
    if (performance.now() > this.drivesUntil) return;
    this.drivesAgain = false;
    if (driver === "nobody") this.session.send({ type: "drive", on: true });
  }

  /** Looks from where the address says; false where it says nothing. */
  camera(): boolean {
    const [numbers, orthographic] = [this.shownCamera, this.shownProjection];
    this.shownCamera = this.shownProjection = null;
    if (orthographic !== null) this.stage.setOrthographic(orthographic);
    if (!numbers) return false;
    this.stage.place(numbers);
    return true;
  }

  private shownCamera: number[] | null = null;
  private shownProjection: boolean | null = null;

  private read(): void {
    const read = parse(location.hash);
    if (typeof read === "string") this.say(read, true);
    else this.wanted = read;
    this.shownCamera = this.wanted?.camera ?? null;
    this.shownProjection = this.wanted?.orthographic ?? null;
  }

  private apply(scene: Scene): void {
    const shot = this.wanted;
    this.wanted = null;
    if (!shot) return;
    if (shot.model !== scene.name) {
      this.shownCamera = this.shownProjection = null;
      this.say(`The address is for ${shot.model}, but the model is ${scene.name}; it was ignored.`, true);
      return;
    }
    const { session } = this;
    if (shot.frame && shot.frame !== scene.frame) session.send({ type: "frame", name: shot.frame });
    if (shot.task && shot.task !== scene.task.name) session.send({ type: "task", name: shot.task });
    if (shot.actuated && scene.actuators.length > 0) session.send({ type: "actuated", names: shot.actuated });
    if (shot.method && JSON.stringify(shot.method) !== JSON.stringify(scene.method)) session.send({ type: "method", ...shot.method });
    if (shot.playing === false) session.send({ type: "pause" });
    this.obstacles(shot, scene);
    session.send({ type: "configuration", q: shot.q });
    if (shot.target) session.send({ type: "target", ...shot.target });
    const known = new Set<string>(scene.overlays.map((info) => info.name));
    for (const name of shot.overlays ?? []) if (known.has(name)) this.overlays.show(name, true);
  }

  /** A new session has the obstacles of its server: those of the same name are moved, others removed. */
  private obstacles(shot: Snapshot, scene: Scene): void {
    const { session } = this;
    const there = new Set(scene.obstacles.map(({ name }) => name));
    const kept = new Set(shot.obstacles?.map(({ name }) => name));
    for (const { name, kind } of shot.obstacles ? scene.obstacles : []) {
      if (!kept.has(name) && kind !== "mesh") session.send({ type: "remove_obstacle", name });
    }
    for (const { name, shape, position, quaternion } of shot.obstacles ?? []) {
      if (there.has(name)) session.send({ type: "move_obstacle", name, position, quaternion });
      else session.send({ type: "add_obstacle", name, shape, position, quaternion });
    }
    const { avoidance } = shot;
    if (avoidance) session.send({ type: "avoid_collisions", on: true, ...avoidance });
    else if (avoidance === null && scene.avoidance) session.send({ type: "avoid_collisions", on: false, gap: null, margin: null });
  }
}
