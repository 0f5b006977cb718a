/** What a program draws beside the robot: frames, lines and points, with their names. */
import { BufferGeometry, Color, Float32BufferAttribute, Group, Line, LineBasicMaterial, Points, PointsMaterial, type Object3D } from "three";
import type { Drawing, Drawings as Message } from "./protocol";
import { setPose } from "./robot/skeleton";
import type { Label, Labels } from "./scene/labels";
import { drawn, hair } from "./scene/palette";
import { discard, rod, vector } from "./scene/shapes";

const AXES = ["axis-x", "axis-y", "axis-z"] as const;
/** Colour of what a program gives none. */
const PLAIN = "c-principal";
/** Length of the axes of a frame, and thickness of points, as shares of the robot's size. */
const [AXIS, DOT] = [0.1, 0.012];

export class Drawings {
  readonly group = new Group();
  private all: Drawing[] = [];
  private size = 1;
  private readonly known = new Map<string, { object: Object3D; told: string }>();

  constructor(private readonly labels: Labels) {}

  /** The drawings in place of those before. */
  show({ drawings }: Message): void {
    this.all = drawings;
    this.build();
  }

  /** The size of the robot (m). */
  scale(size: number): void {
    if (size === this.size) return;
    this.size = size;
    this.clear();
    this.build();
  }

  private build(): void {
    const names = new Set(this.all.map(({ name }) => name));
    for (const [name, { object }] of this.known) {
      if (names.has(name)) continue;
      this.drop(object);
      this.known.delete(name);
    }
    for (const drawing of this.all) this.make(drawing);
    this.labels.set("drawings", this.all.flatMap((drawing) => this.label(drawing)));
  }

  private make(drawing: Drawing): void {
    const told = JSON.stringify(drawing);
    const known = this.known.get(drawing.name);
    if (known?.told === told) return;
    if (known) this.drop(known.object);
    const object = this.object(drawing);
    object.name = drawing.name;
    this.group.add(object);
    this.known.set(drawing.name, { object, told });
  }

  private object(drawing: Drawing): Object3D {
    if (drawing.kind === "frame") {
      const length = drawing.size ?? AXIS * this.size;
      const frame = new Group();
      AXES.forEach((colour, i) => {
        const tip = [0, 0, 0].map((_, k) => (k === i ? length : 0));
        frame.add(rod(vector([0, 0, 0]), vector(tip), 0.03 * length, drawn(colour)));
      });
      setPose(frame, drawing.pose);
      return frame;
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(drawing.points.flat(), 3));
    const { rgba } = drawing;
    const own = rgba && { color: new Color(rgba[0], rgba[1], rgba[2]), opacity: rgba[3], transparent: rgba[3] < 1 };
    const plain = { color: hair(PLAIN).color };
    if (drawing.kind === "line") return new Line(geometry, new LineBasicMaterial(own ?? plain));
    return new Points(geometry, new PointsMaterial({ ...(own ?? plain), size: DOT * this.size }));
  }

  /** Frames have their names beside them. */
  private label(drawing: Drawing): Label[] {
    return drawing.kind === "frame" ? [{ text: drawing.name, at: vector(drawing.pose.position), colour: PLAIN }] : [];
  }

  private clear(): void {
    for (const { object } of this.known.values()) this.drop(object);
    this.known.clear();
  }

  private drop(object: Object3D): void {
    if (object instanceof Line || object instanceof Points) (object.material as LineBasicMaterial).dispose();
    discard(object);
  }
}
