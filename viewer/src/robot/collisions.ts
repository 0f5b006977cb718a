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
  private generation = 0;

  constructor(private readonly tell: { changed: () => void; problems: (sentences: string[]) => void }) {
    this.group.visible = false;
  }

  /** For a new mechanism. */
  build(scene: Scene): void {
    for (const link of this.links) discard(link);
    this.scene = scene;
    this.made = false;
    this.generation += 1;
    this.links = scene.links.map(() => new Group());
    this.group.add(...this.links);
    if (this.group.visible) void this.make();
  }

  show(shown: boolean): void {
    this.group.visible = shown;
    if (shown && !this.made) void this.make();
    this.tell.changed();
  }

  place(state: State): void {
    this.links.forEach((link, i) => {
      const pose = state.links[i];
      if (pose) setPose(link, pose);
    });
  }

  /** A mesh that is not to be had stays away. */
  private async make(): Promise<void> {
    this.made = true;
    const { generation, links } = this;
    const problems: string[] = [];
    const paint = glass("c-collision", 0.35);
    // Just before the shapes of the model, which are often the same.
    [paint.polygonOffset, paint.polygonOffsetFactor, paint.polygonOffsetUnits] = [true, -2, -2];
    const work = (this.scene?.links ?? []).flatMap((link, i) =>
      link.collisions.map(async (shape) => {
        try {
          const holder = new Group();
          setPose(holder, shape.pose);
          holder.add(await paintedBody(shape, paint));
          if (generation !== this.generation) return;
          links[i]?.add(holder);
          this.tell.changed();
        } catch (error) {
          problems.push(`${link.name}: ${error instanceof Error ? error.message : String(error)}`);
        }
      }),
    );
    await Promise.all(work);
    if (generation === this.generation) this.tell.problems(problems);
  }
}
