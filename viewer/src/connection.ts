/** The line to the server: says whether it is open, comes back by itself with growing pauses. */

export type Link = "connecting" | "open" | "lost";
type Handlers = {
  message: (raw: string) => void;
  /** While the line is lost, `wait` is the pause before the next attempt (s); `wasOpen` is false where it could not be opened. */
  link: (link: Link, wait: number, wasOpen: boolean) => void;
};

const FIRST_PAUSE = 0.5;
const LONGEST_PAUSE = 8;

export class Connection {
  private socket: WebSocket | null = null;
  private pause = FIRST_PAUSE;
  private timer = 0;
  private link: Link = "connecting";
  private isClosed = false;
  private readonly online = (): void => this.retry();

  /** `url` is asked for anew for each attempt. */
  constructor(private readonly url: () => string, private readonly handlers: Handlers) {
    this.open();
    addEventListener("online", this.online);
  }

  /** Sends a message; false where there is no line. */
  send(message: object): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  /** Ends it for good. */
  close(): void {
    this.isClosed = true;
    removeEventListener("online", this.online);
    this.leave();
  }

  /** Tries now instead of after the pause. */
  retry(): void {
    if (this.link === "lost") this.renew();
  }

  /** Opens another line in place of this one. */
  renew(): void {
    if (this.isClosed) return;
    this.leave();
    this.open();
  }

  /** The server answers as it should: the next pause is the first again. */
  settle(): void {
    this.pause = FIRST_PAUSE;
  }

  private leave(): void {
    const { socket } = this;
    this.socket = null;
    clearTimeout(this.timer);
    socket?.close();
  }

  private open(): void {
    const socket = new WebSocket(this.url());
    let wasOpen = false;
    this.socket = socket;
    socket.onopen = () => {
      wasOpen = true;
      this.tell("open", 0, wasOpen);
    };
    socket.onmessage = (event) => {
      if (socket === this.socket && typeof event.data === "string") this.handlers.message(event.data);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      this.tell("lost", this.pause, wasOpen);
      this.timer = window.setTimeout(() => this.open(), this.pause * 1000);
      this.pause = Math.min(this.pause * 1.7, LONGEST_PAUSE);
    };
  }

  private tell(link: Link, wait: number, wasOpen: boolean): void {
    this.link = link;
    this.handlers.link(link, wait, wasOpen);
  }
}

/** The address of a session of an opened model, or of that of the command. */
export function socketTo(model: string | null, session: string, observes: boolean): string {
  const url = new URL("./ws", location.href);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  [url.search, url.hash] = ["", ""];
  if (model !== null) url.searchParams.set("model", model);
  url.searchParams.set("session", session);
  if (observes) url.searchParams.set("observe", "");
  return url.href;
}

/** The address of the server that gave this page. */
export function socketUrl(path: string): string {
  const url = new URL(path, location.href);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  // Of the words in the page's address those are the server's.
  const asked = new URLSearchParams(location.search);
  for (const name of ["session", "observe", "model"]) {
    const value = asked.get(name);
    if (value !== null) url.searchParams.set(name, value);
  }
  url.hash = "";
  return url.href;
}
