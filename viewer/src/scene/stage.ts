/** The view: camera, lights, ground; draws only when somebody said that something changed. */
import {
  AmbientLight, Box3, Color, DirectionalLight, HemisphereLight, Mesh, MOUSE, OrthographicCamera, PerspectiveCamera,
  PlaneGeometry, Scene, ShadowMaterial, Sphere, TOUCH, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { colour, onTheme } from "../theme";
import { ground, type Ground } from "./ground";

export type View = "corner" | "front" | "side" | "top";
const FROM: Record<View, [number, number, number]> = {
  corner: [1.1, -1.5, 0.85],
  front: [0, -1, 0.0001],
  side: [1, 0, 0.0001],
  top: [0, -0.0001, 1],
};

/** A planar mechanism is seen flat from within this angle about z (rad): a drag pans, and does not tilt it. */
const FLAT = 1e-3;
const KEYS = "arrow keys pan, with Shift they rotate, plus and minus zoom, 1 to 4 look from a corner, the front, a side and above, F fits all.";
const DRAGS = {
  turns: `View of the robot. Drag to rotate, wheel to zoom, right button to pan; ${KEYS}`,
  pans: `View of the mechanism in its plane. Drag to pan, wheel to zoom, right button to rotate; ${KEYS}`,
};

/** One key press of zooming, of turning (in steps of OrbitControls) and of panning (pixels). */
const ZOOM = 1.15;
const KEY_TURN = 6;
const KEY_PAN = 24;

export class Stage {
  readonly scene = new Scene();
  /** It is turned, moved and zoomed. */
  readonly camera = new PerspectiveCamera(35, 1, 0.01, 100);
  /** Follows it: the same direction, and the same size at the point that is turned about. */
  private readonly parallel = new OrthographicCamera();
  /** What is looked through. */
  eye: PerspectiveCamera | OrthographicCamera = this.camera;
  private readonly eyes = new Set<(eye: PerspectiveCamera | OrthographicCamera) => void>();
  readonly renderer: WebGLRenderer;
  readonly orbit: OrbitControls;
  private readonly before = new Set<() => void>();
  private readonly sun = new DirectionalLight(0xffffff, 2.1);
  private readonly floor = new Mesh(new PlaneGeometry(1, 1), new ShadowMaterial({ opacity: 0.2 }));
  private grid: Ground | null = null;
  private scheduled = false;
  private fitted = new Sphere(new Vector3(), 1);
  private planar = false;
  /** Frames drawn, for tests that a page at rest draws none. */
  frames = 0;

  constructor(private readonly element: HTMLElement) {
    const slow = softwareRendered();
    this.renderer = new WebGLRenderer({ antialias: !slow, alpha: true });
    this.renderer.setPixelRatio(slow ? 1 : Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    element.prepend(canvas);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener("change", () => {
      this.chooseDrag();
      this.invalidate();
    });
    this.orbit.listenToKeyEvents(canvas);
    [this.orbit.keyRotateSpeed, this.orbit.keyPanSpeed] = [KEY_TURN, KEY_PAN];
    canvas.addEventListener("keydown", ({ key, ctrlKey, metaKey, altKey }) => {
      const way = { "+": -1, "=": -1, "-": 1 }[key];
      if (way !== undefined && !(ctrlKey || metaKey || altKey)) this.zoom(ZOOM ** way);
    });
    this.chooseDrag();
    this.lights(!slow);
    new ResizeObserver(() => this.resize()).observe(element);
    onTheme(() => this.paint());
    canvas.addEventListener("webglcontextrestored", () => this.invalidate());
  }

  /** Something changed: draw it in the next frame. */
  invalidate(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.draw();
    });
  }

  /** Called before each drawing. */
  onFrame(work: () => void): void {
    this.before.add(work);
  }

  /** Sets the scale of grid, shadow and clipping; `size` is that of the robot (m). */
  scale(size: number, floor: number): void {
    this.camera.near = size * 0.005;
    this.camera.far = size * 60;
    this.sun.position.set(1.2, -1.6, 3).multiplyScalar(size);
    const shadow = this.sun.shadow.camera;
    [shadow.left, shadow.right, shadow.top, shadow.bottom] = [-1.6 * size, 1.6 * size, 1.6 * size, -1.6 * size];
    [shadow.near, shadow.far] = [0.1 * size, 8 * size];
    shadow.updateProjectionMatrix();
    this.floor.scale.setScalar(8 * size);
    this.floor.position.z = floor - 0.001 * size;
    if (this.grid) this.scene.remove(this.grid.object);
    this.grid = ground(size);
    this.grid.object.position.z = floor - 0.002 * size;
    this.scene.add(this.grid.object);
    this.paint();
  }

  get isOrthographic(): boolean {
    return this.eye === this.parallel;
  }

  setOrthographic(orthographic: boolean): void {
    this.eye = orthographic ? this.parallel : this.camera;
    this.follow();
    for (const told of this.eyes) told(this.eye);
    this.chooseDrag();
    this.invalidate();
  }

  /** For a planar mechanism. */
  setPlanar(planar: boolean): void {
    this.planar = planar;
    this.chooseDrag();
  }

  /** What the pointer does: a mechanism that is seen in its plane stays flat. */
  private chooseDrag(): void {
    const way = this.camera.position.clone().sub(this.orbit.target).normalize();
    const pans = this.planar && this.isOrthographic && Math.hypot(way.x, way.y) < FLAT;
    const [first, second] = pans ? [MOUSE.PAN, MOUSE.ROTATE] : [MOUSE.ROTATE, MOUSE.PAN];
    this.orbit.mouseButtons = { LEFT: first, MIDDLE: MOUSE.DOLLY, RIGHT: second };
    this.orbit.touches = { ONE: pans ? TOUCH.PAN : TOUCH.ROTATE, TWO: pans ? TOUCH.DOLLY_ROTATE : TOUCH.DOLLY_PAN };
    this.renderer.domElement.setAttribute("aria-label", pans ? DRAGS.pans : DRAGS.turns);
  }

  /** Called when another camera is looked through. */
  onEye(told: (eye: PerspectiveCamera | OrthographicCamera) => void): void {
    this.eyes.add(told);
  }

  private follow(): void {
    const { camera, parallel } = this;
    const high = camera.position.distanceTo(this.orbit.target) * Math.tan((camera.fov * Math.PI) / 360);
    [parallel.top, parallel.bottom, parallel.right, parallel.left] = [high, -high, high * camera.aspect, -high * camera.aspect];
    // From so far behind that nothing is behind it: rays of the pointer begin there.
    [parallel.near, parallel.far] = [0, 2 * camera.far];
    parallel.quaternion.copy(camera.quaternion);
    parallel.position.copy(camera.position);
    parallel.translateZ(camera.far);
    parallel.updateProjectionMatrix();
    parallel.updateMatrixWorld();
  }

  /** Shows all of a box. */
  fit(box: Box3): void {
    if (box.isEmpty()) return;
    this.frame(box);
    this.look(this.camera.position.clone().sub(this.orbit.target));
  }

  /** What the next view shows all of. */
  frame(box: Box3): void {
    if (!box.isEmpty()) box.getBoundingSphere(this.fitted);
  }

  view(view: View): void {
    this.look(new Vector3(...FROM[view]));
  }

  /** Where the camera is and what it looks at; it is put there if this is given. */
  place(numbers?: number[]): number[] {
    const { camera, orbit } = this;
    if (numbers) {
      const [x = 0, y = 0, z = 1, tx = 0, ty = 0, tz = 0] = numbers;
      orbit.target.set(tx, ty, tz);
      camera.position.set(x, y, z);
      orbit.update();
    }
    return [...camera.position.toArray(), ...orbit.target.toArray()];
  }

  /** Brings the camera to this share of its distance. */
  private zoom(share: number): void {
    const { target } = this.orbit;
    this.camera.position.sub(target).multiplyScalar(share).add(target);
    this.orbit.update();
    this.invalidate();
  }

  private look(direction: Vector3): void {
    const { center, radius } = this.fitted;
    const across = Math.min(1, this.camera.aspect);
    const distance = (radius * 1.06) / Math.sin((this.camera.fov * Math.PI) / 360) / across;
    this.orbit.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction.normalize(), distance);
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.invalidate();
  }

  /** The view as a PNG, on its background. */
  async png(): Promise<Blob> {
    const { width, height } = this.renderer.domElement;
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    this.paintOn(canvas);
    return new Promise((resolve, reject) => {
      canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture could not be encoded"))), "image/png");
    });
  }

  /** What is seen, as large as the canvas. */
  paintOn(canvas: HTMLCanvasElement): void {
    this.draw();
    const context = canvas.getContext("2d");
    if (!context) throw new Error("this browser does not support 2D canvases");
    const gradient = context.createLinearGradient(0, 0, 0, canvas.height);
    gradient.addColorStop(0, colour("stage-top"));
    gradient.addColorStop(1, colour("stage-bottom"));
    context.fillStyle = gradient;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(this.renderer.domElement, 0, 0, canvas.width, canvas.height);
  }

  private draw(): void {
    for (const work of this.before) work();
    if (this.isOrthographic) this.follow();
    this.renderer.render(this.scene, this.eye);
    this.frames += 1;
  }

  private lights(shadows: boolean): void {
    this.scene.add(new HemisphereLight(0xffffff, 0x8a8f98, 1.35), new AmbientLight(0xffffff, 0.35), this.sun);
    const rim = new DirectionalLight(0xdfe8f5, 0.9);
    rim.position.set(-2, 1.5, 1);
    this.scene.add(rim);
    if (!shadows) return;
    this.renderer.shadowMap.enabled = true;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.normalBias = 0.01;
    this.sun.shadow.radius = 5;
    this.floor.receiveShadow = true;
    this.scene.add(this.floor);
  }

  private paint(): void {
    this.grid?.paint(new Color(colour("grid")), new Color(colour("grid-strong")));
    this.invalidate();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }
}

/** Whether the processor makes the pixels: smooth edges and shadows would cost it more than they show. */
function softwareRendered(): boolean {
  if (new URLSearchParams(location.search).get("quality") === "high") return false;
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}
