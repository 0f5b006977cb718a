/** One session with the server: the newest scene and state, and everything that wants to know of them. */
import { Connection, type Link } from "./connection";
import { Outbox } from "./outbox";
import type { About, Comparison, Drawings, Failure, FromServer, ModelNews, Postures, Report, Scene, State, ToServer } from "./protocol";

type Events = {
  scene: Scene;
  state: State;
  compare: Comparison;
  report: Report;
  states: Postures;
  failure: Failure;
  about: About;
  drawings: Drawings;
  model: ModelNews;
  /** A message, before it goes. */
  sending: ToServer;
  link: { link: Link; wait: number; wasOpen: boolean };
  /** A state as it came, before any is dropped: for recordings. */
  raw: string;
};

/** What an observer may send. */
const OBSERVES: readonly ToServer["type"][] = ["overlays", "compare", "report", "states", "distances", "drive", "seen"];

const STATE_START = '{"type":"state"';
const ACK = /"ack":(\d+)/;
const SEQ = /"seq":(\d+)/;

export class Session {
  scene: Scene | null = null;
  state: State | null = null;
  /** Null for a session of this page alone. */
  about: About | null = null;
  link: Link = "connecting";
  /** The server is there, but does not have the model of this session. */
  isModelGone = false;
  /** Wants every state, drawn or not: the server then holds none back for a slow page. */
  eager = false;
  private readonly listeners: { [K in keyof Events]?: ((event: Events[K]) => void)[] } = {};
  private readonly connection: Connection;
  private newest: string | null = null;
  /** When the newest state and the one that was handed on came (ms). */
  private newestCame = 0;
  private came = 0;
  private ids = 0;
  private readonly outbox: Outbox;

  /** `wake` asks for a frame; `takeNewest` is to be called in it. */
  constructor(url: () => string, private readonly wake: () => void) {
    this.outbox = new Outbox((message) => this.send(message));
    this.connection = new Connection(url, {
      message: (raw) => this.receive(raw),
      link: (link, wait, wasOpen) => {
        this.link = link;
        if (link !== "open") this.newest = null;
        if (link === "lost") this.about = null;
        // There is no server: what the last one said is over.
        if (!wasOpen) this.isModelGone = false;
        this.outbox.clear();
        this.emit("link", { link, wait, wasOpen });
      },
    });
  }

  on<K extends keyof Events>(event: K, listener: (event: Events[K]) => void): void {
    const all = (this.listeners[event] ??= []) as ((event: Events[K]) => void)[];
    all.push(listener);
  }

  /** False while another page, or nobody, drives the robot. */
  get drives(): boolean {
    return this.about === null || this.about.driver === "you";
  }

  /** Sends at once; gives the id that the answer will carry. An observer sends nothing that moves the robot. */
  send(message: ToServer): number | null {
    if (!this.drives && !OBSERVES.includes(message.type)) return null;
    this.emit("sending", message);
    const id = (this.ids += 1);
    return this.connection.send({ id, ...message }) ? id : null;
  }

  /** Sends what is dragged: of several under one key the newest, when the last one is answered. */
  sendSoon(key: string, message: ToServer): void {
    this.outbox.put(key, message);
  }

  close(): void {
    this.connection.close();
  }

  retry(): void {
    this.connection.retry();
  }

  /** Connects anew, also where the line is not known to be lost. */
  reconnect(): void {
    this.connection.renew();
  }

  /** Since the newest state came (s). */
  get age(): number {
    return (performance.now() - this.came) / 1000;
  }

  /** Hands the newest state on, once. */
  takeNewest(): void {
    if (this.newest === null) return;
    const raw = this.newest;
    this.newest = null;
    this.state = JSON.parse(raw) as State;
    this.came = this.newestCame;
    this.emit("state", this.state);
    if (!this.eager) this.connection.send({ type: "seen", seq: this.state.seq });
  }

  private receive(raw: string): void {
    if (raw.startsWith(STATE_START)) {
      this.receiveState(raw);
      return;
    }
    let message: FromServer;
    try {
      message = JSON.parse(raw) as FromServer;
    } catch {
      console.warn("the server sent invalid JSON");
      return;
    }
    if (message.type === "scene") {
      const same = this.scene?.links.length === message.links.length && this.scene.name === message.name;
      this.scene = message;
      if (!same) this.state = null;
      this.isModelGone = false;
      this.connection.settle();
      this.emit("scene", message);
    } else if (message.type === "session") {
      this.about = message;
      this.emit("about", message);
    } else if (message.type === "model") {
      this.emit("model", message);
    } else if (message.type === "drawings") {
      this.emit("drawings", message);
      this.wake();
    } else if (message.type === "state") {
      this.receiveState(raw);
    } else if (message.type === "error") {
      this.outbox.answered(message.reply_to);
      if (message.place === "model") this.isModelGone = true;
      this.emit("failure", message);
    } else if (message.type === "compare" || message.type === "report" || message.type === "states") {
      this.emit(message.type as "compare", message as Comparison);
    }
  }

  private receiveState(raw: string): void {
    this.emit("raw", raw);
    const start = raw.slice(0, 200);
    const ack = ACK.exec(start)?.[1];
    if (ack) this.outbox.answered(Number(ack));
    const seq = SEQ.exec(start)?.[1];
    if (this.eager && seq) this.connection.send({ type: "seen", seq: Number(seq) });
    this.newestCame = performance.now();
    this.newest = raw; // older ones that nobody has drawn are gone
    this.wake();
  }

  private emit<K extends keyof Events>(event: K, value: Events[K]): void {
    for (const listener of this.listeners[event] ?? []) listener(value);
  }
}
