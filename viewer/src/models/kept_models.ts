/**
 * The models that a server has opened for this page. The page keeps the requests that opened them, files included,
 * and sends them again to a server that was restarted.
 */
import type { Refusal } from "../protocol";
import type { Session } from "../session";
import { sentence } from "./refusal";

type Told = {
  /** False for an observer: the page that drives opens the model again. `isKept`: this page has its request. */
  opens: (isKept: boolean) => boolean;
  /** The model is not open on this server and will not be; said once. `isKept`: the next server is asked again. */
  failed: (words: string, isKept: boolean) => void;
};

export class KeptModels {
  private readonly requests = new Map<string, Promise<Blob>>();
  private readonly openings = new Map<string, Promise<string | null>>();
  /** Why the server that runs now has refused a model; the next one may take it. */
  private readonly refused = new Map<string, string>();
  /** Sessions of each model. */
  private readonly sessions = new Map<string, number>();

  /** Keeps the model of a session, and opens it again where the server does not have it; gives what ends that. */
  follow(session: Session, id: string, { opens, failed }: Told): () => void {
    let [isOpened, isTold, isOver] = [false, false, false];
    const fail = (words: string): void => {
      if (!isTold) failed(words, this.requests.has(id));
      isTold = true;
    };
    const keep = (): void => {
      if (session.link === "open" && !session.isModelGone && session.scene && session.drives && !isOver) this.keep(id);
    };
    this.sessions.set(id, (this.sessions.get(id) ?? 0) + 1);
    session.on("about", keep);
    session.on("scene", () => {
      isOpened = isTold = false;
      keep();
    });
    session.on("link", ({ wasOpen }) => {
      if (wasOpen) return;
      isOpened = isTold = false;
      this.refused.delete(id);
    });
    session.on("failure", ({ place, message }) => {
      if (place !== "model" || !opens(this.requests.has(id))) return;
      // What was opened and is not there would be opened for ever.
      if (isOpened) {
        fail(message);
        return;
      }
      this.open(id, message).then((why) => {
        if (isOver) return;
        isOpened = why === null;
        if (why === null) session.reconnect();
        else fail(why);
      }, () => undefined); // the server is gone again: the next one is asked
    });
    return () => {
      isOver = true;
      const left = (this.sessions.get(id) ?? 1) - 1;
      this.sessions.set(id, left);
      if (left > 0) return;
      this.requests.delete(id);
      this.refused.delete(id);
    };
  }

  private keep(id: string): void {
    if (this.requests.has(id)) return;
    const request = fetched(id);
    this.requests.set(id, request);
    request.catch(() => this.requests.delete(id));
  }

  /** Null once it is open, otherwise why it is not: `unknown` where it is not kept. Rejects where the server is gone. */
  private open(id: string, unknown: string): Promise<string | null> {
    const known = this.openings.get(id);
    if (known) return known;
    const opening = this.post(id, unknown).finally(() => this.openings.delete(id));
    this.openings.set(id, opening);
    return opening;
  }

  private async post(id: string, unknown: string): Promise<string | null> {
    const request = this.requests.get(id);
    if (!request) return unknown;
    const refused = this.refused.get(id);
    if (refused !== undefined) return refused;
    const answer = await fetch("./models", { method: "POST", body: await request });
    if (answer.ok) return null;
    const isJson = answer.headers.get("content-type")?.includes("json");
    const why = `The model could not be opened again. ${isJson ? sentence((await answer.json()) as Refusal) : await answer.text()}`;
    this.refused.set(id, why);
    return why;
  }
}

async function fetched(id: string): Promise<Blob> {
  const answer = await fetch(`./models/${encodeURIComponent(id)}`);
  if (!answer.ok) throw new Error(await answer.text());
  return answer.blob();
}
