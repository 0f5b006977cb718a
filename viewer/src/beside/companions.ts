/** Models that are shown beside the first; the address of the page names them. */
import { Box3, Group, Vector3 } from "three";
import { socketTo } from "../connection";
import { h } from "../dom";
import { panel } from "../panels/panel";
import type { Pose } from "../protocol";
import { Companion } from "./companion";

const PARAMETER = "beside";
/** In the address, for the model of the command. */
const COMMAND = "command";
/** Room between models, as a share of their sizes. */
const ROOM = 0.2;
const MOST = 8;

type Told = { changed: () => void; say: (words: string, bad?: boolean) => void; box: () => Box3 };

export class Companions {
  readonly panel = panel("beside", "Beside", true);
  readonly group = new Group();
  private readonly all = new Map<string, Companion>();
  private readonly list = h("div", {});
  private count = 0;

  constructor(private readonly tell: Told) {
    this.panel.body.append(h("p", { class: "note" }, "Each of these models has a session of its own here. Open it in a window of its own to drag its target."), this.list);
    for (const id of new URL(location.href).searchParams.getAll(PARAMETER)) this.begin(id);
    this.show();
  }

  /** Shows a model beside the first: one that the server has opened, or null for that of the command. */
  add(id: string | null): void {
    if (this.all.size >= MOST) {
      this.tell.say(`${MOST} models are shown beside the first; remove one of them.`, true);
      return;
    }
    this.begin(id ?? COMMAND);
    this.show();
    this.panel.element.open = true;
  }

  /** With the models in it. */
  within(box: Box3): Box3 {
    return this.all.size > 0 ? box.union(new Box3().setFromObject(this.group)) : box;
  }

  /** Before each drawing. */
  takeNewest(): void {
    for (const { session } of this.all.values()) session.takeNewest();
  }

  private begin(id: string): void {
    this.count += 1;
    const key = `${id} ${this.count}`;
    const companion = new Companion(this.count, socketTo(id === COMMAND ? null : id), {
      changed: this.tell.changed,
      say: this.tell.say,
      place: (box) => this.placeFor(box, companion),
      remove: () => {
        companion.close();
        this.all.delete(key);
        this.show();
        (this.list.querySelector("button") ?? document.querySelector("canvas"))?.focus();
        this.tell.changed();
      },
    });
    this.all.set(key, companion);
    this.group.add(companion.group);
    this.list.append(companion.element);
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
    for (const key of this.all.keys()) url.searchParams.append(PARAMETER, key.split(" ")[0] ?? "");
    if (url.href !== location.href) window.history.replaceState(null, "", url.href);
  }
}
