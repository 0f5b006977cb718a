/** Marks an item in the view: its bodies in another colour, its frame, its name, and the axis of a joint. */
import { Group, Mesh, Vector3, type Object3D } from "three";
import type { Scene } from "../protocol";
import type { Robot } from "../robot/robot";
import { setPose } from "../robot/skeleton";
import type { Labels } from "../scene/labels";
import { drawn, glass } from "../scene/palette";
import { rod, vector } from "../scene/shapes";
import type { Item } from "./items";

const AXES = ["axis-x", "axis-y", "axis-z"] as const;
export const COLOUR = "c-selected";
/** Lengths of the axes of a frame and of half the axis of a joint, as shares of the robot's size. */
const [FRAME, AXIS] = [0.1, 0.16];

export class Mark {
  readonly group = new Group();
  private readonly bodies = new Group();
  /** In the link that the item is fixed to. */
  private readonly inLink = new Group();
  private readonly frame = new Group();
  private copies: { copy: Mesh; of: Mesh }[] = [];
  private item: Item | null = null;
  private scene: Scene | null = null;
  private size = 1;

  constructor(private readonly robot: Robot, private readonly labels: Labels) {
    this.inLink.matrixAutoUpdate = false;
    this.inLink.add(this.frame);
    this.group.add(this.bodies, this.inLink);
  }

  /** The size of the robot (m). */
  scale(size: number): void {
    this.size = size;
    this.show(this.item, this.scene);
  }

  /** Marks this item in place of the last; also after bodies have come or gone. */
  show(item: Item | null, scene: Scene | null): void {
    [this.item, this.scene] = [item, scene];
    this.bodies.clear();
    this.frame.clear();
    this.copies = [];
    this.group.visible = item !== null;
    if (!item || !scene) {
      this.labels.set("selected", []);
      return;
    }
    const paint = glass(COLOUR, 0.55);
    // Just before the body itself.
    [paint.polygonOffset, paint.polygonOffsetFactor, paint.polygonOffsetUnits] = [true, -4, -4];
    for (const of of this.robot.meshesOf(item)) {
      const copy = new Mesh(of.geometry, paint);
      copy.matrixAutoUpdate = false;
      this.bodies.add(copy);
      this.copies.push({ copy, of });
    }
    if (item.pose) this.drawFrame(item, scene);
    this.place();
  }

  /** Where the robot is now. */
  place(): void {
    const { item } = this;
    const link = item && this.robot.linkFrame(item.link);
    if (!item || !link) return;
    this.robot.group.updateMatrixWorld();
    for (const { copy, of } of this.copies) copy.matrix.copy(of.matrixWorld);
    this.inLink.matrix.copy(link.matrixWorld);
    this.group.updateMatrixWorld(true);
    const at = item.pose ? this.frame.getWorldPosition(new Vector3()) : centre(this.copies.map(({ of }) => of));
    this.labels.set("selected", at ? [{ text: item.name, at, colour: COLOUR }] : []);
  }

  private drawFrame(item: Item, scene: Scene): void {
    if (item.pose) setPose(this.frame, item.pose);
    const length = FRAME * this.size;
    const zero = new Vector3();
    AXES.forEach((colour, i) => this.frame.add(rod(zero, new Vector3().setComponent(i, length), 0.035 * length, drawn(colour))));
    const joint = item.kind === "joint" ? scene.joints[item.index] : undefined;
    if (!joint || joint.kind === "fixed" || joint.kind === "free" || joint.kind === "spherical") return;
    const half = vector(joint.axis).multiplyScalar(AXIS * this.size);
    this.frame.add(rod(half.clone().negate(), half, 0.02 * length, drawn(COLOUR)));
  }
}

/** Where a body without a frame of its own is. */
function centre(bodies: Object3D[]): Vector3 | null {
  return bodies[0] ? bodies[0].getWorldPosition(new Vector3()) : null;
}
