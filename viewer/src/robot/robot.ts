/** The robot: one group for each link, moved to where the server says it is. */
import { Box3, Group, Mesh, SphereGeometry, Vector3, type Object3D } from "three";
import type { Scene, State } from "../protocol";
import { drawn, glass, solid } from "../scene/palette";
import { isShown } from "../scene/picking";
import { along, arrow, discard, drum, rod, vector } from "../scene/shapes";
import { visualBody } from "./meshes";
import { sizes, type Sizes } from "./plan";
import { axisInParent, jointMark, linkBody, mark, setPose, Slide } from "./skeleton";

/** What a body belongs to: a link, a joint or a loop joint, by its number. */
export type Owner = { kind: "link" | "joint" | "loop"; index: number };
type Told = { changed: () => void; problems: (sentences: string[]) => void };

export class Robot {
  readonly group = new Group();
  private links: { frame: Group; skeleton: Group; shapes: Group }[] = [];
  private slides: { slide: Slide; parent: number; from: Vector3; child: number; to: Vector3 }[] = [];
  private loops: { ball: Object3D; open: Mesh }[] = [];
  private contacts: { arrow: Object3D; open: Mesh }[] = [];
  private readonly owners = new Map<Object3D, Owner>();
  private size: Sizes = { rod: 0.01, joint: 0.02 };
  private generation = 0;
  private shown = true;
  hasShapes = false;

  constructor(private readonly tell: Told) {}

  build(scene: Scene): void {
    this.generation += 1;
    for (const child of [...this.group.children]) discard(child);
    this.size = sizes(scene);
    [this.slides, this.loops, this.contacts] = [[], [], []];
    this.owners.clear();
    this.links = scene.links.map(({ name }, index) => {
      const frame = new Group();
      frame.name = name;
      const [skeleton, shapes] = [linkBody(scene, index, this.size), new Group()];
      frame.add(skeleton, shapes);
      this.group.add(frame);
      this.owners.set(frame, { kind: "link", index });
      return { frame, skeleton, shapes };
    });
    scene.joints.forEach((joint, index) => {
      const drawing = jointMark(scene, joint, this.size);
      if (drawing) this.links[joint.parent]?.skeleton.add(drawing);
      const slide = joint.kind === "prismatic" || joint.kind === "cylindrical" ? this.addSlide(scene, joint) : null;
      for (const body of [drawing, slide]) if (body) this.owners.set(body, { kind: "joint", index });
    });
    scene.loops.forEach(({ kind, actuated }, index) => {
      const loop = this.loop(scene, kind, actuated);
      this.loops.push(loop);
      this.owners.set(loop.ball, { kind: "loop", index });
    });
    for (const _ of scene.contacts) this.contacts.push(this.contact());
    this.hasShapes = scene.links.some((link) => link.visuals.length > 0);
    void this.load(scene, this.generation);
  }

  place(state: State): void {
    state.links.forEach((pose, i) => {
      const link = this.links[i];
      if (link) setPose(link.frame, pose);
    });
    this.group.updateMatrixWorld();
    for (const { slide, parent, from, child, to } of this.slides) {
      const [a, b] = [this.links[parent], this.links[child]];
      if (a && b) slide.between(a.frame.localToWorld(from.clone()), b.frame.localToWorld(to.clone()));
    }
    state.loops.forEach(({ a, b }, i) => {
      const loop = this.loops[i];
      if (!loop) return;
      loop.ball.position.set(...a);
      stretch(loop.open, vector(a), vector(b), this.size.rod * 0.2);
    });
    state.contacts.forEach(({ point, normal, other }, i) => {
      const contact = this.contacts[i];
      if (!contact) return;
      contact.arrow.position.set(...point);
      along(contact.arrow, vector(normal));
      stretch(contact.open, vector(point), vector(other), this.size.rod * 0.2);
    });
  }

  /** Shapes of the file, or rods for all. */
  showShapes(shown: boolean): void {
    this.shown = shown;
    for (const link of this.links) this.choose(link);
    this.tell.changed();
  }

  box(): Box3 {
    this.group.updateMatrixWorld(true);
    return new Box3().setFromObject(this.group);
  }

  /** The link, joint or loop joint that a body belongs to. */
  ownerOf(body: Object3D): Owner | null {
    for (let at: Object3D | null = body; at; at = at.parent) {
      const owner = this.owners.get(at);
      if (owner) return owner;
    }
    return null;
  }

  /** The meshes by which an item is shown now. */
  meshesOf({ kind, index }: { kind: string; index: number }): Mesh[] {
    const found: Mesh[] = [];
    this.group.traverse((part) => {
      if (!(part instanceof Mesh) || !isShown(part)) return;
      const owner = this.ownerOf(part);
      if (owner?.kind === kind && owner.index === index) found.push(part);
    });
    return found;
  }

  /** The frame of a link, which moves with it. */
  linkFrame(index: number): Object3D | null {
    return this.links[index]?.frame ?? null;
  }

  /** Where the joint of a coordinate is now. */
  jointPlace(scene: Scene, coordinate: number): Vector3 | null {
    const joint = scene.joints[scene.coordinates[coordinate]?.joint ?? -1];
    const parent = joint && this.links[joint.parent];
    return parent ? parent.frame.localToWorld(vector(joint.origin.position)) : null;
  }

  private choose(link: { skeleton: Group; shapes: Group }): void {
    link.shapes.visible = this.shown;
    link.skeleton.visible = !this.shown || link.shapes.children.length === 0;
  }

  /** Brings the shapes in; a link whose shapes all fail keeps its rods. */
  private async load(scene: Scene, generation: number): Promise<void> {
    const problems: string[] = [];
    const work = scene.links.flatMap((link, index) =>
      link.visuals.map(async (visual) => {
        try {
          const body = await visualBody(visual);
          const target = this.links[index];
          if (generation !== this.generation || !target) return;
          target.shapes.add(body);
          this.choose(target);
          this.tell.changed();
        } catch (error) {
          problems.push(`${link.name}: ${error instanceof Error ? error.message : String(error)}`);
        }
      }),
    );
    await Promise.all(work);
    if (generation !== this.generation) return;
    if (this.hasShapes) this.hideMarksOfShaped(scene);
    this.tell.problems(problems);
    this.tell.changed();
  }

  /** The ground of a robot with shapes needs no feet. */
  private hideMarksOfShaped(scene: Scene): void {
    scene.links.forEach((link, i) => {
      const own = this.links[i];
      const isGround = !scene.joints.some((joint) => joint.child === i);
      const carriesShape = scene.joints.some((j) => j.parent === i && (this.links[j.child]?.shapes.children.length ?? 0) > 0);
      if (own && isGround && link.visuals.length === 0 && carriesShape) own.shapes.add(new Group());
      if (own) this.choose(own);
    });
  }

  private addSlide(scene: Scene, joint: Scene["joints"][number]): Object3D | null {
    const child = scene.links[joint.child]?.anchors.find((anchor) => anchor.kind === "joint");
    const parent = scene.links[joint.parent]?.anchors.find((anchor) => anchor.kind === "joint");
    if (!child) return null;
    const at = vector(joint.origin.position);
    const back = parent ? vector(parent.position).sub(at) : new Vector3();
    const inLine = back.lengthSq() > 0 && Math.abs(Math.sin(back.angleTo(axisInParent(joint)))) < 0.02;
    const from = inLine ? at.clone().addScaledVector(back, 0.6) : at;
    const slide = new Slide(this.size.rod * 0.75);
    this.slides.push({ slide, parent: joint.parent, from, child: joint.child, to: vector(child.position) });
    this.group.add(slide.object);
    return slide.object;
  }

  private loop(scene: Scene, kind: string, actuated: boolean): { ball: Object3D; open: Mesh } {
    const flat = scene.dimension === 2;
    const up = new Vector3(0, 0, 1);
    const ball =
      (flat ? mark(kind, new Vector3(), up, actuated, this.size, true) : null) ??
      new Mesh(new SphereGeometry(this.size.joint * 1.05, 28, 18), solid(actuated ? "joint-actuated" : "joint-passive"));
    return this.withGap(ball);
  }

  private contact(): { arrow: Object3D; open: Mesh } {
    const group = new Group();
    const up = new Vector3(0, 1, 0);
    group.add(arrow(new Vector3(), up.clone().multiplyScalar(this.size.joint * 3.5), this.size.joint * 0.18, drawn("c-contact")));
    group.add(drum(new Vector3(), up, this.size.joint * 1.5, this.size.joint * 0.15, glass("c-contact", 0.5)));
    const { ball, open } = this.withGap(group);
    return { arrow: ball, open };
  }

  private withGap(ball: Object3D): { ball: Object3D; open: Mesh } {
    const open = rod(new Vector3(), new Vector3(), 0, drawn("c-lost"));
    this.group.add(ball, open);
    return { ball, open };
  }
}

/** A unit rod between two points; gone where they are one. */
function stretch(object: Mesh, from: Vector3, to: Vector3, radius: number): void {
  const way = to.clone().sub(from);
  const length = way.length();
  object.visible = length > radius * 0.05;
  object.position.copy(from).addScaledVector(way, 0.5);
  if (!object.visible) return;
  object.scale.set(radius, length, radius);
  along(object, way);
}
