/** The obstacles in the view: bodies that the handle drags. */
import { Group, Raycaster, Vector2, type Object3D } from "three";
import type { Obstacle, Scene, State } from "./protocol";
import { paintedBody } from "./robot/meshes";
import { setPose } from "./robot/skeleton";
import { glass } from "./scene/palette";
import { discard } from "./scene/shapes";
import type { Stage } from "./scene/stage";

/** A pointer that moved farther between down and up has dragged (pixels). */
const CLICK = 4;

type Told = { picked: (name: string) => void; problem: (sentence: string) => void };

export class Obstacles {
  readonly group = new Group();
  private readonly bodies = new Map<string, { object: Group; shape: string }>();
  private names: string[] = [];

  constructor(private readonly stage: Stage, private readonly tell: Told, isHandle: () => boolean) {
    const canvas = stage.renderer.domElement;
    let down: [number, number] | null = null;
    canvas.addEventListener("pointerdown", (event) => {
      down = event.button === 0 && !isHandle() ? [event.clientX, event.clientY] : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK) this.pick(event);
      down = null;
    });
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

  private pick(event: PointerEvent): void {
    const box = this.stage.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.stage.eye);
    let hit: Object3D | null = ray.intersectObject(this.group, true)[0]?.object ?? null;
    while (hit && hit.parent !== this.group) hit = hit.parent;
    if (hit) this.tell.picked(hit.name);
  }
}
