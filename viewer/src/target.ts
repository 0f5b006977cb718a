/** The target of the servo as a frame that can be dragged; the handle also moves a reference point or an obstacle. */
import { AxesHelper, type Box3, Color, Group, Mesh, Object3D, OctahedronGeometry, Vector3 } from "three";
import { TransformControls } from "three/addons/controls/TransformControls.js";
import type { Pose, Scene, State, Vec3 } from "./protocol";
import { drawn, hair } from "./scene/palette";
import { rod } from "./scene/shapes";
import type { Stage } from "./scene/stage";
import { colour, onTheme } from "./theme";
import { setPose } from "./robot/skeleton";

export type Mode = "translate" | "rotate";
export type Handle = "target" | "point" | "obstacle";
type Moved = {
  target: (pose: Pose) => void; point: (position: Vec3) => void; obstacle: (name: string, pose: Pose) => void;
  /** A drag has ended, and the states show its result. */
  settled: () => void;
};

/** How long after a drag states may still be of before its end (ms). */
const QUIET = 300;

export class Target {
  mode: Mode = "translate";
  handle: Handle = "target";
  /** The obstacle at the handle. */
  obstacle: string | null = null;
  private readonly gizmo: TransformControls;
  private readonly target = new Object3D();
  private readonly point = new Object3D();
  private readonly marks = new Group();
  private readonly axes = { target: new AxesHelper(1), tool: new AxesHelper(1) };
  private readonly way = new Group();
  private task: string[] = [];
  private dragging = false;
  private quiet = false;
  private last: Pose | null = null;

  constructor(private readonly stage: Stage, private readonly moved: Moved) {
    this.gizmo = new TransformControls(stage.eye, stage.renderer.domElement);
    stage.onEye((eye) => (this.gizmo.camera = eye));
    this.gizmo.setSize(0.85);
    this.gizmo.addEventListener("dragging-changed", (event) => {
      this.dragging = event.value === true;
      stage.orbit.enabled = !this.dragging;
      this.quiet = true;
      if (!this.dragging) setTimeout(() => this.settle(), QUIET);
    });
    this.gizmo.addEventListener("objectChange", () => this.tell());
    this.gizmo.addEventListener("change", () => stage.invalidate());
    const ball = new Mesh(new OctahedronGeometry(1), drawn("c-principal", 0.9));
    ball.name = "ball";
    this.point.add(ball);
    this.point.visible = false;
    this.target.add(this.axes.target);
    this.marks.add(this.target, this.point, this.axes.tool, this.way);
    stage.scene.add(this.marks, this.gizmo.getHelper());
    onTheme(() => this.paint());
    this.paint();
    this.gizmo.attach(this.target);
  }

  scale(size: number): void {
    this.axes.target.scale.setScalar(0.11 * size);
    this.axes.tool.scale.setScalar(0.08 * size);
    this.point.getObjectByName("ball")?.scale.setScalar(0.018 * size);
  }

  build(scene: Scene): void {
    this.task = scene.task.components;
    this.choose();
  }

  place(state: State, size: number): void {
    this.last = state.target;
    if (!this.quiet) setPose(this.target, state.target);
    setPose(this.axes.tool, state.tool);
    this.way.clear();
    const [from, to] = [new Vector3(...state.tool.position), this.target.position];
    if (from.distanceTo(to) > 0.005 * size) this.way.add(rod(from, to, 0.003 * size, drawn("c-target", 0.6)));
  }

  /** An observer has no handle. */
  setEnabled(enabled: boolean): void {
    this.gizmo.enabled = enabled;
    this.gizmo.getHelper().visible = enabled;
    this.stage.invalidate();
  }

  /** A box with the target and its handle in it. */
  within(box: Box3): Box3 {
    const room = this.axes.target.scale.x * 1.6;
    return box.expandByPoint(this.target.position.clone().addScalar(room)).expandByPoint(this.target.position.clone().addScalar(-room));
  }

  setMode(mode: Mode): void {
    this.mode = mode;
    this.choose();
  }

  setSpace(space: "world" | "local"): void {
    this.gizmo.setSpace(space);
    this.stage.invalidate();
  }

  setHandle(handle: "target" | "point"): void {
    [this.handle, this.obstacle] = [handle, null];
    this.gizmo.attach(handle === "target" ? this.target : this.point);
    this.choose();
  }

  /** Puts the handle on an obstacle. */
  hold(name: string, object: Object3D): void {
    [this.handle, this.obstacle] = ["obstacle", name];
    this.gizmo.attach(object);
    this.choose();
  }

  /** The obstacle that is dragged: states may still be of before. */
  dragged(): string | null {
    return this.quiet ? this.obstacle : null;
  }

  /** True while the pointer is over the handle. */
  isHovered(): boolean {
    return this.gizmo.axis !== null;
  }

  showPoint(position: Vec3 | null): void {
    this.point.visible = position !== null;
    if (position && !this.dragging) this.point.position.set(...position);
    this.stage.invalidate();
  }

  /** After a drag the states on the way are old; then the target is where the server has it. */
  private settle(): void {
    if (this.dragging) return;
    this.quiet = false;
    if (this.last) setPose(this.target, this.last);
    this.moved.settled();
    this.stage.invalidate();
  }

  /** The handle shows what the task minds, and a point can only be moved. */
  private choose(): void {
    const translate = this.handle === "point" || this.mode === "translate";
    const names = translate ? ["x", "y", "z"] : ["rx", "ry", "rz"];
    const all = this.handle !== "target" || this.task.length === 0;
    this.gizmo.setMode(translate ? "translate" : "rotate");
    [this.gizmo.showX, this.gizmo.showY, this.gizmo.showZ] = names.map((n) => all || this.task.includes(n)) as [boolean, boolean, boolean];
    this.stage.invalidate();
  }

  private tell(): void {
    if (this.handle === "point") {
      this.moved.point(this.point.position.toArray() as Vec3);
      return;
    }
    const object = this.handle === "obstacle" ? this.gizmo.object : this.target;
    if (!object) return;
    const { x, y, z, w } = object.quaternion;
    const pose: Pose = { position: object.position.toArray() as Vec3, quaternion: [w, x, y, z] };
    if (this.obstacle === null) this.moved.target(pose);
    else this.moved.obstacle(this.obstacle, pose);
  }

  private paint(): void {
    const [x, y, z] = (["axis-x", "axis-y", "axis-z"] as const).map((name) => new Color(colour(name)));
    if (!x || !y || !z) return;
    this.gizmo.setColors(x, y, z, new Color(colour("c-active-force")));
    for (const axes of Object.values(this.axes)) {
      axes.setColors(x, y, z);
      const material = hair("ink").clone();
      material.vertexColors = true;
      material.color.set(0xffffff);
      axes.material = material;
    }
    this.stage.invalidate();
  }
}
