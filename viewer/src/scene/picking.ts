/** Clicks in the view: the nearest body or point under the pointer. A drag is none, and neither is a press on the handle. */
import { Raycaster, Vector2, type Object3D } from "three";
import type { Stage } from "./stage";

/** A pointer that moved farther between down and up has dragged (pixels). */
const CLICK = 4;

type Hit = { distance: number; pick: () => void };
/** What a click on the ray, at this event, would pick. */
type Source = (ray: Raycaster, event: PointerEvent) => Hit | null;

export class Picking {
  private readonly sources: Source[] = [];
  private nothing = (): void => undefined;

  constructor(private readonly stage: Stage, isHandle: () => boolean) {
    const canvas = stage.renderer.domElement;
    let down: [number, number] | null = null;
    canvas.addEventListener("pointerdown", (event) => {
      // A second finger turns or zooms.
      down = event.button === 0 && event.isPrimary && !isHandle() ? [event.clientX, event.clientY] : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK) this.pick(event);
      down = null;
    });
  }

  /** Bodies that can be picked. */
  add(group: Object3D, picked: (object: Object3D) => void): void {
    this.addSource((ray) => {
      const hit = ray.intersectObject(group, true).find(({ object }) => isShown(object));
      return hit ? { distance: hit.distance, pick: () => picked(hit.object) } : null;
    });
  }

  /** Other things that can be picked. */
  addSource(source: Source): void {
    this.sources.push(source);
  }

  /** Called for a click beside all bodies. */
  onNothing(work: () => void): void {
    this.nothing = work;
  }

  private pick(event: PointerEvent): void {
    const box = this.stage.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.stage.eye);
    const hits = this.sources.flatMap((source) => source(ray, event) ?? []);
    const [nearest] = hits.sort((a, b) => a.distance - b.distance);
    if (nearest) nearest.pick();
    else this.nothing();
  }
}

/** Rays meet hidden bodies, too. */
export function isShown(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent) if (!at.visible) return false;
  return true;
}
