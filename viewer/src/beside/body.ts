/** A robot that stands elsewhere than at the origin, solid or transparent. */
import { Group, Mesh, type Material } from "three";
import type { Pose, Scene } from "../protocol";
import { Robot } from "../robot/robot";
import { setPose } from "../robot/skeleton";
import { glass } from "../scene/palette";

type Told = { changed: () => void; problems: (sentences: string[]) => void };

export class Body {
  readonly group = new Group();
  readonly robot: Robot;
  private readonly paints = new Map<Mesh, Material | Material[]>();
  private built: Scene | null = null;
  private bodies = "";
  private isTransparent = false;

  constructor(private readonly tell: Told) {
    this.robot = new Robot({ changed: () => this.paint(), problems: tell.problems });
    this.group.add(this.robot.group);
  }

  build(scene: Scene): void {
    if (scene === this.built) return;
    this.built = scene;
    const bodies = JSON.stringify([scene.name, scene.links, scene.joints, scene.loops, scene.contacts]);
    if (bodies === this.bodies) return;
    this.bodies = bodies;
    this.paints.clear();
    this.robot.build(scene);
    this.paint();
  }

  stand(pose: Pose, transparent: boolean): void {
    setPose(this.group, pose);
    if (transparent !== this.isTransparent) {
      this.isTransparent = transparent;
      this.paint();
    }
    this.tell.changed();
  }

  /** Bodies come one after the other. */
  private paint(): void {
    const glassy = glass("c-ghost", 0.35);
    this.robot.group.traverse((part) => {
      if (!(part instanceof Mesh)) return;
      const own = this.paints.get(part) ?? part.material;
      this.paints.set(part, own);
      part.material = this.isTransparent ? glassy : own;
    });
    this.tell.changed();
  }
}
