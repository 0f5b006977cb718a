/** Records the session, opens motions of files, and shows a moment of them in place of the robot as it is. */
import type { Look } from "../film/film";
import type { Posture, Scene, State, ToServer } from "../protocol";
import type { Session } from "../session";
import { STEP } from "./columns";
import { Dock } from "./dock";
import { Elsewhere, measuresAlike } from "./elsewhere";
import { readMotion, type Motion, type Sample } from "./motion";
import { Player } from "./player";
import { Plots } from "./plots";
import { MOST, Recording, type Past } from "./recording";
import { Saves, type View } from "./saves";
import { Trail } from "./trail";

type Told = {
  /** Another moment, or the robot as it is, is to be drawn. */
  redraw: () => void;
  /** Another moment, or the robot as it is, is wanted. */
  moved: () => void;
  /** A frame is wanted. */
  wake: () => void;
  say: (words: string, bad?: boolean) => void;
  /** A recording goes on, is complete, or there is none. */
  changed: (recording: boolean, states: number) => void;
  /** What the server has to send for the overlays and panels that are open: names, and distances or not. */
  wanted: () => { overlays: string[]; distances: boolean };
  size: () => number;
  /** From where one looks, and what is drawn beside the robot. */
  look: () => Look;
  view: View;
  /** What stands beside the robot is recorded with it, or no longer. */
  recordBeside: (recording: Recording | null) => void;
  /** What stands beside the robot is shown as it was, or as it is. */
  showBeside: (past: Past | null) => void;
};
export type Moment = { scene: Scene; state: State };

/** Messages that change nothing about the robot: they are sent while a recording is shown. */
const READS: readonly ToServer["type"][] = ["overlays", "compare", "report", "distances", "states", "beside", "drive", "seen"];
/** Messages that do not go on from the moment shown. */
const FRESH: readonly ToServer["type"][] = ["configuration", "reset", "play", "pause"];
/** Between drawings of what grows (ms). */
const PAUSE = 250;

export class Timeline {
  readonly plots: Plots;
  readonly trail = new Trail();
  private readonly dock: Dock;
  private readonly player: Player;
  private readonly elsewhere: Elsewhere;
  private recording: Recording | null = null;
  private records = false;
  private showsTrail = true;
  /** The moment that is shown, if it is not the robot as it is. */
  private current: (Moment & { index: number }) | null = null;
  /** Wanted by the player, and not shown yet. */
  private wanted: number | null = null;
  private asking = false;
  /** Who waits until this state is shown. */
  private awaited: { index: number; resolve: (shown: boolean) => void } | null = null;
  /** The moment of the recording that is shown or will be. */
  private here: number | null = null;
  private later = 0;
  private saidOf: Recording | null = null;

  constructor(dock: HTMLElement, private readonly session: Session, private readonly tell: Told) {
    this.player = new Player(() => this.move(), () => this.dock.playing(this.player.playing));
    const { say, look, view } = tell;
    const saves = new Saves({ recording: () => this.recording, plots: () => this.plots.picture(), look, view, show: (time) => this.showAt(time), say });
    this.plots = new Plots((time) => {
      this.player.pause();
      this.player.seek(time);
    }, saves.elements, saves.after);
    this.dock = new Dock(dock, this.player, {
      live: () => this.live(),
      trail: (shown) => {
        this.showsTrail = shown;
        this.drawTrail();
      },
    });
    this.dock.playing(false);
    this.elsewhere = new Elsewhere(session);
    session.on("raw", (raw) => this.take(raw));
    session.on("scene", (scene) => this.takeScene(scene));
    session.on("link", ({ link }) => link === "lost" && this.recording?.lose());
    session.on("sending", (message) => this.takeOver(message));
    this.exists(false);
  }

  /** What is shown in place of the robot as it is. */
  get moment(): Moment | null {
    return this.current;
  }

  get isRecording(): boolean {
    return this.records;
  }

  /** The user began something: a mark of the recording. */
  noteStep(): void {
    if (this.records) this.recording?.columns.marks.mark(STEP);
  }

  /** Where a recording is shown, whether a step of the user lies before or after that moment. */
  get steps(): { before: boolean; after: boolean } | null {
    const { recording, here } = this;
    // A motion of a file has no steps of the user.
    return recording && recording.file === null && here !== null ? { before: here > 0, after: here < recording.length - 1 } : null;
  }

  /** Where a recording is shown, shows the moment before a step of the user, or after it; false elsewhere. */
  step(way: -1 | 1): boolean {
    const { recording, here } = this;
    if (!recording || recording.file !== null || here === null) return false;
    this.player.pause();
    this.player.seek(recording.columns.time.at(recording.columns.step(here, way)));
    return true;
  }

  owns(id: unknown): boolean {
    return this.elsewhere.owns(id);
  }

  record(): void {
    if (this.records) {
      this.stop();
      return;
    }
    const { scene, state } = this.session;
    if (!scene || !state) return;
    this.live();
    this.records = this.session.eager = true;
    this.replace(new Recording(scene));
    this.recording?.begin(state, this.session.age);
    this.tell.recordBeside(this.recording);
    this.grow();
  }

  /** Shows the motion of a file. */
  async open(file: File): Promise<void> {
    const { scene } = this.session;
    if (!scene) return;
    let motion: Motion;
    try {
      motion = await readMotion(file, scene);
    } catch (error) {
      this.tell.say(error instanceof Error ? error.message : String(error), true);
      return;
    }
    if (this.records) this.stop();
    const { samples } = motion;
    const recording = new Recording(scene, file.name);
    const takesTarget = motion.frame === null || motion.frame === scene.frame;
    this.live();
    this.replace(recording);
    try {
      const isWhole = await this.elsewhere.askAll(samples.map(({ q }) => q), (i, posture) => {
        const sample = samples[i];
        if (!sample) return;
        const state = stateOf(i, sample, posture, file.name, takesTarget);
        recording.take(sample.time, JSON.stringify(state), state);
      }, (done) => {
        if (this.recording !== recording) return false;
        this.grow();
        if (this.current === null && this.wanted === null) this.player.seek(0);
        this.tell.changed(false, done);
        return true;
      });
      if (!isWhole) {
        if (this.recording === recording) await this.open(file);
        return;
      }
      if (!motion.hasTimes) this.tell.say(`${file.name} has no times: it is shown with 60 samples per second.`);
      if (!takesTarget) this.tell.say(`The motion of ${file.name} is that of ${motion.frame}; errors are of that frame, the tool and its singular values are of ${scene.frame}.`);
    } catch (error) {
      this.tell.say(`${file.name}: ${error instanceof Error ? error.message : String(error)}`, true);
    }
  }

  /** The robot as it is. */
  live(): void {
    if (!this.leave()) return;
    this.dock.at(this.recording?.end ?? 0, true);
    this.tell.redraw();
  }

  /** Overlays or panels may show something else of the same moment. */
  refresh(): void {
    if (this.current) this.want(this.current.index);
  }

  /** Before each drawing: shows the newest moment that is wanted. */
  flush(): void {
    const { wanted, recording } = this;
    if (wanted === null || !recording || this.asking) return;
    this.wanted = null;
    const state = recording.stateAt(wanted);
    if (!state) return;
    const moment = { scene: recording.sceneAt(wanted), state, index: wanted };
    const { scene } = this.session;
    const isOfScene = scene !== null && measuresAlike(scene, moment.scene);
    if (!isOfScene || this.isComplete(state)) {
      this.show(moment);
      if (!isOfScene) this.sayOther(recording, state);
      return;
    }
    this.asking = true;
    this.elsewhere.ask([state.q], true).then(
      ([posture]) => this.answered(recording, { ...moment, state: completed(state, posture) }),
      () => this.answered(recording, moment),
    );
  }

  /** What the server would compute is of another frame, task, choice of actuated joints or version of the model: said once. */
  private sayOther(recording: Recording, state: State): void {
    if (recording === this.saidOf || this.isComplete(state)) return;
    this.saidOf = recording;
    this.tell.say("Overlays and distances that were not recorded are not shown: the robot has another frame, task, choice of actuated joints or version of its model now.");
  }

  private answered(recording: Recording, moment: Moment & { index: number }): void {
    this.asking = false;
    // Somebody may have left the recording meanwhile.
    if (recording === this.recording && this.here !== null) this.show(moment);
    if (this.wanted !== null) this.tell.wake();
  }

  private show(moment: Moment & { index: number }): void {
    this.current = moment;
    this.plots.at(moment.index, this.player.time);
    this.showBeside();
    this.tell.redraw();
    if (moment.index === this.awaited?.index) this.end(true);
  }

  /** Shows this time, with all that is to be seen of it; false where something else is shown meanwhile. */
  private showAt(time: number): Promise<boolean> {
    this.player.pause();
    this.end(false);
    return new Promise((resolve) => {
      this.awaited = { index: this.recording?.columns.indexAt(time) ?? 0, resolve };
      this.player.seek(time);
      if (this.wanted === null && this.awaited.index === this.current?.index) this.end(true);
      else this.flush();
    });
  }

  private end(shown: boolean): void {
    const { awaited } = this;
    this.awaited = null;
    awaited?.resolve(shown);
  }

  private move(): void {
    if (!this.recording) return;
    const { time } = this.player;
    const index = this.recording.columns.indexAt(time);
    this.dock.at(time, false);
    if (index === this.current?.index && this.wanted === null) {
      this.plots.at(index, time);
      this.showBeside();
    } else {
      this.want(index);
    }
  }

  /** Motions of files have nothing beside them. */
  private showBeside(): void {
    const { recording, current } = this;
    this.tell.showBeside(recording && recording.file === null && current ? { recording, time: this.player.time, scene: current.scene } : null);
  }

  private want(index: number): void {
    this.wanted = this.here = index;
    if (this.awaited && index !== this.awaited.index) this.end(false);
    this.tell.moved();
    this.tell.wake();
  }

  private leave(): boolean {
    this.player.pause();
    this.end(false);
    this.wanted = this.here = null;
    const left = this.current !== null;
    this.current = null;
    if (left) this.showBeside();
    this.tell.moved();
    return left;
  }

  /** A recorded state has what was shown when it came. */
  private isComplete(state: State): boolean {
    const { overlays, distances } = this.tell.wanted();
    const have = Object.keys(state.overlays);
    return overlays.every((name) => have.includes(name)) && (!distances || state.distances !== null);
  }

  private stop(): void {
    this.records = this.session.eager = false;
    this.tell.recordBeside(null);
    this.plots.show(this.recording);
    this.tell.changed(false, this.recording?.length ?? 0);
  }

  private take(raw: string): void {
    const { recording } = this;
    if (!this.records || !recording) return;
    recording.takeLive(raw);
    if (recording.isFull) this.stopFull();
    this.grow();
  }

  private stopFull(): void {
    this.stop();
    this.tell.say(`The recording has ${MOST} states and has stopped; save it, or record again.`);
  }

  /** What stands beside the robot has moved. */
  growBeside(): void {
    const { recording } = this;
    if (!this.records || !recording) return;
    if (recording.tracks().some(([, { isFull }]) => isFull)) this.stopFull();
    this.grow();
  }

  /** The recording has become longer. */
  private grow(): void {
    const { recording } = this;
    if (!recording) return;
    const { end } = recording;
    this.player.setEnd(end);
    this.dock.show(recording.columns, end);
    if (this.here === null) {
      this.dock.at(end, true);
      this.player.time = end;
      this.plots.at(recording.length - 1, end);
    } else {
      this.dock.at(this.player.time, false);
    }
    this.plots.grow();
    this.tell.moved();
    this.later ||= window.setTimeout(() => {
      this.later = 0;
      this.dock.paint();
      this.drawTrail();
    }, PAUSE);
    if (this.records) this.tell.changed(true, recording.length);
  }

  private drawTrail(): void {
    if (this.recording && this.showsTrail) this.trail.draw(this.recording.columns, this.tell.size());
    else this.trail.clear();
    this.tell.wake();
  }

  private replace(recording: Recording | null): void {
    this.leave();
    this.recording = recording;
    this.player.time = 0;
    this.exists(recording !== null);
    this.plots.show(recording);
    this.drawTrail();
  }

  private exists(there: boolean): void {
    this.dock.element.hidden = !there;
    this.plots.panel.element.hidden = !there;
    document.documentElement.toggleAttribute("data-recording", there);
  }

  private takeScene(scene: Scene): void {
    const { recording } = this;
    if (!recording) return;
    const names = (of: Scene): string => JSON.stringify([of.name, of.coordinates.map(({ name }) => name), of.links.length]);
    if (names(scene) === names(recording.scene)) {
      if (this.records) recording.changeScene(scene);
      return;
    }
    if (this.records) this.stop();
    this.replace(null);
    this.tell.changed(false, 0);
  }

  /** Who moves the robot while a recording is shown goes on from the moment shown. */
  private takeOver({ type }: ToServer): void {
    if (!this.current || READS.includes(type)) return;
    const { q } = this.current.state;
    this.leave();
    this.dock.at(this.recording?.end ?? 0, true);
    if (!FRESH.includes(type)) this.session.send({ type: "configuration", q });
  }
}

/** The sample of a motion as a state; without a target of its own, that is at the tool. */
function stateOf(i: number, sample: Sample, posture: Posture, file: string, takesTarget: boolean): State {
  const { time, error, joint_velocities, limits } = sample;
  return {
    type: "state", seq: i, time, clock: time, ack: null, playing: false,
    target: (takesTarget ? sample.target : null) ?? posture.tool,
    error,
    servo: { status: "paused", reason: null, sentence: `Sample ${i + 1} of ${file}.`, limits, pair: null, self_motion: 0, joint_velocities, twist: null },
    ...posture,
  };
}

/** With overlays and distances that were computed now, where the obstacles have not moved. */
function completed(state: State, posture: Posture | undefined): State {
  if (!posture) return state;
  const same = JSON.stringify(posture.obstacles) === JSON.stringify(state.obstacles);
  return { ...state, overlays: { ...posture.overlays, ...state.overlays }, distances: state.distances ?? (same ? posture.distances : null) };
}
