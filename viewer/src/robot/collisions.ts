/** The collision shapes of the links, made when they are first shown. */
import { Group } from "three";
import type { Scene, State } from "../protocol";
import { glass } from "../scene/palette";
import { discard } from "../scene/shapes";
import { paintedBody } from "./meshes";
import { setPose } from "./skeleton";

export class Collisions {
  readonly group = new Group();
  private links: Group[] = [];
  private scene: Scene | null = null;
  private made = false;

  constructor(private readonly changed: () => void) {
    this.group.visible = false;
  }

  /** For a new mechanism. */
  build(scene: Scene): void {
    for (const link of this.links) discard(link);
    this.scene = scene;
    this.made = false;
    this.links = scene.links.map(() => new Group());
    this.group.add(...this.links);
    if (this.group.visible) this.make();
  }

  show(shown: boolean): void {
    this.group.visible = shown;
    if (shown && !this.made) this.make();
    this.changed();
  }

  place(state: State): void {
    this.links.forEach((link, i) => {
      const pose = state.links[i];
      if (pose) setPose(link, pose);
    });
  }

  /** A mesh that is not to be had stays away: the panel lists its distances none the less. */
  private make(): void {
    this.made = true;
    const paint = glass("c-collision", 0.35);
    // Just before the shapes of the model, which are often the same.
    [paint.polygonOffset, paint.polygonOffsetFactor, paint.polygonOffsetUnits] = [true, -2, -2];
    this.scene?.links.forEach((link, i) => {
      for (const shape of link.collisions) {
        paintedBody(shape, paint).then(
          (body) => {
            const holder = new Group();
            setPose(holder, shape.pose);
            holder.add(body);
            this.links[i]?.add(holder);
            this.changed();
          },
          () => undefined,
        );
      }
    });
  }
}
