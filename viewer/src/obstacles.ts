/** The obstacles in the view: bodies that the handle drags. */
import { Group, type Object3D } from "three";
import type { Obstacle, Scene, State } from "./protocol";
import { paintedBody } from "./robot/meshes";
import { setPose } from "./robot/skeleton";
import { glass } from "./scene/palette";
import type { Picking } from "./scene/picking";
import { discard } from "./scene/shapes";
import type { Stage } from "./scene/stage";

type Told = { picked: (name: string) => void; problem: (sentence: string) => void };

export class Obstacles {
  readonly group = new Group();
  private readonly bodies = new Map<string, { object: Group; shape: string }>();
  private names: string[] = [];

  constructor(private readonly stage: Stage, private readonly tell: Told, picking: Picking) {
    picking.add(this.group, (object) => this.pick(object));
  }

  build(scene: Scene): void {
    this.names = scene.obstacles.map(({ name }) => name);
    for (const [name, { object }] of this.bodies) {
      if (this.names.includes(name)) continue;
      discard(object);
      this.bodies.delete(name);
    }
    for (const obstacle of scene.obstacles) this.make(obstacle);
  }

  /** Where the server has them, but for one that is dragged. */
  place(state: State, dragged: string | null): void {
    this.names.forEach((name, i) => {
      const [body, pose] = [this.bodies.get(name), state.obstacles[i]];
      if (body && pose && name !== dragged) setPose(body.object, pose);
    });
  }

  object(name: string): Object3D | null {
    return this.bodies.get(name)?.object ?? null;
  }

  private make(obstacle: Obstacle): void {
    const shape = JSON.stringify(obstacle);
    const known = this.bodies.get(obstacle.name);
    if (known?.shape === shape) return;
    if (known) discard(known.object);
    const object = new Group();
    object.name = obstacle.name;
    this.bodies.set(obstacle.name, { object, shape });
    this.group.add(object);
    paintedBody(obstacle, glass("c-obstacle", 0.62)).then(
      (body) => {
        object.add(body);
        this.stage.invalidate();
      },
      (error: unknown) => this.tell.problem(`${obstacle.name}: ${error instanceof Error ? error.message : String(error)}`),
    );
  }

  private pick(object: Object3D): void {
    let hit: Object3D | null = object;
    while (hit && hit.parent !== this.group) hit = hit.parent;
    if (hit) this.tell.picked(hit.name);
  }
}
