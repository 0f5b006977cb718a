/** The points of a table in the view: coloured, cut by a plane, and clicked. */
import { Box3, BufferAttribute, BufferGeometry, Group, Plane, Points, PointsMaterial, Vector2, Vector3 } from "three";
import type { Picking } from "../scene/picking";
import type { Stage } from "../scene/stage";
import { coloursOf } from "./colours";
import type { Table } from "./table";

/** Farthest from the pointer that a point is clicked (pixels). */
const NEAR = 8;

export type Axis = "x" | "y" | "z";

export class Cloud {
  readonly group = new Group();
  private points: Points<BufferGeometry, PointsMaterial> | null = null;
  /** What lies on its far side is cut away. */
  private readonly plane = new Plane(new Vector3(-1, 0, 0), 0);
  private isCut = false;

  /** `picked` is called with the row of a point that was clicked. */
  constructor(private readonly stage: Stage, picked: (row: number) => void, picking: Picking) {
    stage.renderer.localClippingEnabled = true;
    picking.addSource((ray, event) => {
      const found = this.at(event, ray.ray.origin);
      return found && { distance: found.distance, pick: () => picked(found.row) };
    });
  }

  /** The points of a table, or none; `size` in pixels. */
  show(table: Table | null, size: number): void {
    this.points?.geometry.dispose();
    this.points?.material.dispose();
    this.points?.removeFromParent();
    this.points = null;
    if (table) {
      const [x, y, z] = ["x", "y", "z"].map((axis) => table.columns.get(axis));
      const places = new Float32Array(3 * table.rows);
      for (let i = 0; i < table.rows; i += 1) places.set([x?.[i] ?? NaN, y?.[i] ?? NaN, z?.[i] ?? 0], 3 * i);
      const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(places, 3));
      const material = new PointsMaterial({ size, sizeAttenuation: false, vertexColors: true, clippingPlanes: this.planes() });
      this.points = new Points(geometry, material);
      this.points.frustumCulled = false;
      this.group.add(this.points);
    }
    this.stage.invalidate();
  }

  paint(values: Float64Array, range: [number, number]): void {
    this.points?.geometry.setAttribute("color", new BufferAttribute(coloursOf(values, range), 3));
    this.stage.invalidate();
  }

  resize(size: number): void {
    if (this.points) this.points.material.size = size;
    this.stage.invalidate();
  }

  /** Leaves out what is beyond this value of a coordinate (m); null leaves all. */
  cut(axis: Axis | null, at: number): void {
    this.isCut = axis !== null;
    if (axis) {
      this.plane.normal.set(axis === "x" ? -1 : 0, axis === "y" ? -1 : 0, axis === "z" ? -1 : 0);
      this.plane.constant = at;
    }
    if (this.points) this.points.material.clippingPlanes = this.planes();
    this.stage.invalidate();
  }

  /** The planes that cut. */
  planes(): Plane[] {
    return this.isCut ? [this.plane] : [];
  }

  /** False for a row that is cut away. */
  shows(row: number): boolean {
    const places = this.points?.geometry.getAttribute("position");
    return !places || !this.isCut || this.plane.distanceToPoint(new Vector3().fromBufferAttribute(places, row)) >= 0;
  }

  /** Where the points are (m). */
  box(): Box3 {
    const box = new Box3();
    const places = this.points?.geometry.getAttribute("position");
    const place = new Vector3();
    for (let i = 0; places && i < places.count; i += 1) {
      place.fromBufferAttribute(places, i);
      if (Number.isFinite(place.x + place.y + place.z)) box.expandByPoint(place);
    }
    return box;
  }

  /** Of the points near the pointer the one in front, and its distance from the eye. */
  private at(event: PointerEvent, eye: Vector3): { row: number; distance: number } | null {
    const places = this.points?.geometry.getAttribute("position");
    if (!places) return null;
    const rectangle = this.stage.renderer.domElement.getBoundingClientRect();
    const pointer = new Vector2(event.clientX - rectangle.left, event.clientY - rectangle.top);
    const place = new Vector3();
    let found: { row: number; distance: number } | null = null;
    for (let row = 0; row < places.count; row += 1) {
      place.fromBufferAttribute(places, row);
      if (this.isCut && this.plane.distanceToPoint(place) < 0) continue;
      const distance = place.distanceTo(eye);
      place.project(this.stage.eye);
      const [x, y] = [((place.x + 1) / 2) * rectangle.width, ((1 - place.y) / 2) * rectangle.height];
      const isNear = Math.hypot(x - pointer.x, y - pointer.y) < NEAR && Math.abs(place.z) < 1;
      if (isNear && (found === null || distance < found.distance)) found = { row, distance };
    }
    return found;
  }
}
