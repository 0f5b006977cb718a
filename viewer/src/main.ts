/** Assembles the page. The server computes; the page sends messages and draws. */
import { Sphere, Vector3 } from "three";
import { Companions } from "./beside/companions";
import { Bar } from "./controls/bar";
import { Joints } from "./controls/joints";
import { Obstacles as ObstaclePanel } from "./controls/obstacles";
import { Role } from "./controls/role";
import { ServoControls } from "./controls/servo";
import { Switches } from "./controls/switches";
import { isTyping, Tools } from "./controls/tools";
import { UnitControls } from "./controls/units";
import { socketUrl } from "./connection";
import { h } from "./dom";
import { download } from "./download";
import { MapPanel } from "./cloud/map_panel";
import { Drawings } from "./drawings";
import { onDrop } from "./files";
import { gltf } from "./gltf";
import { History } from "./history";
import { layout } from "./layout";
import { LinkBanner } from "./link_banner";
import { Overlays } from "./overlays/overlays";
import { Obstacles } from "./obstacles";
import { KeptModels } from "./models/kept_models";
import { News } from "./models/model_news";
import { OpenDialog } from "./models/open_dialog";
import { capabilityPanel } from "./panels/capability";
import { Compare } from "./panels/compare";
import { Distances } from "./panels/distances";
import { mobilityPanel } from "./panels/mobility";
import { posePanel } from "./panels/pose";
import { Reports } from "./panels/reports";
import { screwsPanel } from "./panels/screws";
import { singularPanel } from "./panels/singular";
import type { Scene, State } from "./protocol";
import { Restore } from "./restore";
import { Collisions } from "./robot/collisions";
import { Robot } from "./robot/robot";
import { Labels } from "./scene/labels";
import { Picking } from "./scene/picking";
import { Stage } from "./scene/stage";
import { Session } from "./session";
import { fragment } from "./share";
import { Target } from "./target";
import { Timeline, type Moment } from "./timeline/timeline";
import { keyOf } from "./tree/items";
import { Mark } from "./tree/mark";
import { ModelPanel } from "./tree/model_panel";
import { Selection } from "./tree/selection";
import { inUnits } from "./units";

const root = document.getElementById("app");
if (!root) throw new Error("the page has no element for the viewer");
const page = layout(root);

function start(): void {
  const stage = new Stage(page.stage);
  const session = new Session(() => socketUrl("./ws"), () => stage.invalidate());
  const timeline = new Timeline(page.dock, session, {
    redraw: () => redraw(),
    moved: () => history.tell(),
    wake: () => stage.invalidate(),
    say: page.toast,
    changed: (recording, states) => bar.recorded(recording, states),
    wanted: () => ({ overlays: overlays.names(), distances: distances.panel.isOpen() }),
    size: () => size,
    look: () => ({ camera: stage.place(), orthographic: stage.isOrthographic, overlays: [...overlays.on] }),
    view: { picture: () => stage.png(), paint: (canvas) => stage.paintOn(canvas), size: () => stage.renderer.domElement },
    recordBeside: (recording) => companions.record(recording),
    showBeside: (past) => companions.showPast(past),
  });
  let problemsTold = "";
  const robot = new Robot({
    changed: () => {
      mark.show(selection.marked, session.scene);
      stage.invalidate();
    },
    problems: (sentences) => {
      const told = sentences.join();
      if (sentences.length > 0 && told !== problemsTold) {
        page.toast(`${sentences.length === 1 ? "A shape is" : `${sentences.length} shapes are`} missing and drawn as rods. ${sentences[0] ?? ""}`, true);
      }
      problemsTold = told;
      if (robot.hasShapes && untouched) fitWanted = true;
      redraw();
    },
  });
  const labels = new Labels(page.stage);
  const selection = new Selection();
  const mark = new Mark(robot, labels);
  const modelPanel = new ModelPanel(session, selection);
  page.view.append(modelPanel.card);
  selection.onChange(() => {
    mark.show(selection.marked, session.scene);
    stage.invalidate();
  });
  const overlays = new Overlays(page.legend, labels, (names) => session.send({ type: "overlays", names }));
  const compare = new Compare(session, (point) => {
    target.showPoint(point);
    tools.offerPoint(point !== null);
  });
  const target = new Target(stage, {
    target: (pose) => session.sendSoon("target", { type: "target", ...pose }),
    point: (position) => compare.movePoint(position),
    obstacle: (name, pose) => obstaclePanel.drag(name, pose),
    settled: () => redraw(),
  });
  /** Puts the handle on an obstacle, or back on the target. */
  const hold = (name: string | null): void => {
    const object = name === null ? null : obstacles.object(name);
    if (name !== null && object) target.hold(name, object);
    else if (target.handle === "obstacle") target.setHandle("target");
    obstaclePanel.show(target.obstacle);
    tools.held();
  };
  const picking = new Picking(stage, () => target.isHovered());
  const obstacles = new Obstacles(stage, { picked: hold, problem: (sentence) => page.toast(sentence, true) }, picking);
  picking.add(robot.group, (body) => {
    const owner = robot.ownerOf(body);
    const list = { link: session.scene?.links, joint: session.scene?.joints, loop: session.scene?.loops };
    const name = owner && list[owner.kind]?.[owner.index]?.name;
    if (owner && name !== undefined && name !== null) selection.select(keyOf(owner.kind, name), true);
  });
  picking.onNothing(() => selection.select(null));
  const obstaclePanel = new ObstaclePanel(session, hold);
  let fitWanted = true;
  const models = new KeptModels();
  const companions = new Companions(session, models, {
    changed: () => stage.invalidate(), say: page.toast, box: () => robot.box(),
    acted: () => timeline.live(), recorded: () => timeline.growBeside(),
  });
  const fit = (): void => stage.fit(companions.within(target.within(robot.box())));
  const tools = new Tools(page.tools, target, stage, fit, () => obstaclePanel.show(null));
  const joints = new Joints(session);
  const servo = new ServoControls(session);
  /** What is shown: a moment of a recording, or the robot as it is. */
  const shown = (): Moment | null => timeline.moment ?? (session.scene && session.state ? { scene: session.scene, state: session.state } : null);
  const redraw = (): void => {
    const moment = shown();
    if (moment) draw(moment.scene, moment.state);
    stage.invalidate();
  };
  const collisions = new Collisions({
    changed: () => stage.invalidate(),
    problems: (sentences) => {
      if (sentences.length > 0) {
        page.toast(`${sentences.length === 1 ? "A collision shape is" : `${sentences.length} collision shapes are`} missing. ${sentences[0] ?? ""}`, true);
      }
    },
  });
  const distances = new Distances(session, labels, redraw);
  const switches = new Switches(overlays, { shapes: (shown) => robot.showShapes(shown), collisions: (shown) => collisions.show(shown) }, () => {
    const name = session.scene?.name ?? "cylindroid";
    gltf(name, robot.group).then(
      (blob) => download(blob, `${name}.glb`),
      (error: unknown) => page.toast(`The robot could not be saved: ${String(error)}`, true),
    );
  });
  const map = new MapPanel(session, stage, page.toast, picking);
  const [pose, singular, screws] = [posePanel(), singularPanel(redraw), screwsPanel()];
  const reports = new Reports(session);
  const [mobility, capability] = [mobilityPanel(), capabilityPanel()];
  reports.watch("mobility", mobility);
  reports.watch("manipulability", capability);
  page.left.append(joints.panel.element, switches.panel.element, map.panel.element, modelPanel.panel.element, obstaclePanel.panel.element, servo.panel.element, new UnitControls().panel.element, companions.panel.element);
  page.right.append(...[pose, singular, distances.panel, screws, mobility.panel, capability.panel, compare.panel].map((panel) => panel.element));
  inUnits(page.right, redraw);
  // A folded panel is not kept up to date.
  for (const { onToggle } of [joints.panel, servo.panel, obstaclePanel.panel, pose, singular]) onToggle(redraw);
  const drawings = new Drawings(labels);
  session.on("drawings", (message) => drawings.show(message));
  stage.scene.add(robot.group, companions.group, mark.group, collisions.group, overlays.group, obstacles.group, distances.group, drawings.group, map.cloud.group);

  const wantScrews = (open: boolean): void => overlays.want("principal-screws", open);
  screws.onToggle(wantScrews);
  if (screws.isOpen()) wantScrews(true);

  const bar = new Bar(page.bar, {
    play: () => session.send({ type: "play" }),
    pause: () => session.send({ type: "pause" }),
    reset: () => session.send({ type: "reset" }),
    undo: () => history.undo(),
    redo: () => history.redo(),
    record: () => timeline.record(),
    open: () => void dialog.show(),
    picture: () => {
      stage.png().then(
        (blob) => download(blob, `${session.scene?.name ?? "cylindroid"}.png`),
        (error: unknown) => page.toast(`The picture could not be saved: ${String(error)}`, true),
      );
    },
    share: () => void share(),
  });
  new Role(bar.status, session);
  page.plots.append(timeline.plots.panel.element);
  stage.scene.add(timeline.trail.group);
  const dialog = new OpenDialog((file) => void map.open(file).then((is) => (is ? undefined : timeline.open(file))), (id) => companions.add(id));
  onDrop((files) => void dialog.take(files), (words) => page.toast(`What was dropped cannot be read: ${words}`, true));
  distances.panel.onToggle(() => timeline.refresh());
  const history = new History(session, timeline, (undo, redo) => bar.undoable(undo, redo));
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isTyping(event.target)) return;
    const key = event.key.toLowerCase();
    if (key === "z" && !event.shiftKey) history.undo();
    else if (key === "y" || key === "z") history.redo();
    else return;
    event.preventDefault();
  });
  const restore = new Restore(session, overlays, stage, page.toast, (hasBegun) => {
    distances.ask();
    if (hasBegun) companions.restore();
  }, () => shown() ?? {});
  const model = new URLSearchParams(location.search).get("model");
  if (model !== null) {
    models.follow(session, model, {
      opens: (isKept) => restore.drove === "you" || (isKept && restore.drove === "nobody"),
      failed: (words) => page.toast(words, true),
    });
  }

  async function share(): Promise<void> {
    const shot = restore.now();
    if (!shot) return;
    window.history.replaceState(null, "", fragment(shot));
    try {
      await navigator.clipboard.writeText(location.href);
      page.toast("The link to this configuration is copied and shown in the address bar.");
    } catch {
      page.toast("The address bar contains the link to this configuration.");
    }
  }

  const known = { name: "", bodies: "" };
  session.on("scene", (scene) => {
    const bodies = JSON.stringify([scene.links, scene.joints, scene.loops, scene.contacts]);
    if (isReloaded) [untouched, scaleWanted] = [false, true];
    else if (scene.name !== known.name) fitWanted = true;
    if (isReloaded) history.clear();
    isReloaded = false;
    if (scene.name !== known.name || bodies !== known.bodies) {
      robot.build(scene);
      collisions.build(scene);
      // Until the first state comes.
      if (session.state) robot.place(session.state);
    }
    Object.assign(known, { name: scene.name, bodies });
    modelPanel.build(scene, selection.build(scene));
    mark.show(selection.marked, scene);
    target.build(scene);
    bar.build(scene);
    joints.build(scene);
    servo.build(scene);
    tools.build(scene);
    switches.build(scene, robot.hasShapes);
    obstacles.build(scene);
    const wanted = obstaclePanel.added;
    obstaclePanel.build(scene);
    hold(wanted);
    compare.offer(scene);
    if (restore.scene(scene)) history.clear();
    companions.build(scene);
    stage.invalidate();
  });

  /** The next scene is another version of the model: who looks at it keeps the view. */
  let isReloaded = false;
  let scaleWanted = false;
  new News(page.notice, session, { reloaded: () => (isReloaded = true), say: page.toast });

  /** Nobody has turned the view yet. */
  let untouched = true;
  const touch = (): void => {
    untouched = false;
  };
  stage.orbit.addEventListener("start", touch);
  page.tools.addEventListener("click", touch);
  /** Overlays have a size that suits the robot. */
  let size = 1;
  const scaleAll = (scene: Scene): void => {
    scaleWanted = false;
    const box = robot.box();
    size = Math.max(2.2 * box.getBoundingSphere(new Sphere()).radius, 0.1 * scene.reach);
    target.scale(size);
    drawings.scale(size);
    mark.scale(size);
    stage.scale(size, scene.dimension === 2 ? -0.03 * size : box.min.z);
    stage.setPlanar(scene.dimension === 2);
    stage.frame(companions.within(target.within(box)));
  };
  const fitAll = (scene: Scene): void => {
    fitWanted = false;
    scaleAll(scene);
    fit();
    // Planar mechanisms are seen in their plane.
    stage.setOrthographic(scene.dimension === 2);
    stage.view(scene.dimension === 2 ? "top" : "corner");
    if (restore.camera()) untouched = false;
  };
  const draw = (scene: Scene, state: State): void => {
    robot.place(state);
    collisions.place(state);
    target.place(state, size);
    if (fitWanted) fitAll(scene);
    else if (scaleWanted) scaleAll(scene);
    mark.place();
    modelPanel.place(state);
    overlays.draw(scene, state, { size, jointPlace: (coordinate) => robot.jointPlace(scene, coordinate) });
    if (!timeline.moment) bar.show(state);
    joints.show(state);
    servo.show(state);
    obstacles.place(state, target.dragged());
    obstaclePanel.place(state);
    distances.draw(scene, state, size);
    for (const panel of [pose, singular, screws]) panel.show(scene, state);
    for (const panel of [mobility.panel, capability.panel, compare.panel]) panel.stale(timeline.moment !== null);
  };
  session.on("state", (state) => {
    if (session.scene && !timeline.moment) draw(session.scene, state);
    else bar.show(state);
  });
  session.on("failure", ({ reply_to, message, culprit, place }) => {
    // Controls show what is in effect, not what was refused.
    if (session.scene) for (const controls of [joints, servo]) controls.build(session.scene);
    // That the model is gone is said where it is opened again.
    if (place !== "model" && ![reports, compare, timeline].some((asker) => asker.owns(reply_to))) page.toast(message, true, `${place} ${culprit}`);
  });
  session.on("about", () => {
    const observes = !session.drives;
    for (const { body } of [joints.panel, obstaclePanel.panel, servo.panel]) body.inert = observes;
    bar.observe(observes);
    if (session.scene) modelPanel.build(session.scene, false);
    target.setEnabled(!observes);
  });
  new LinkBanner(page.banner, session);
  session.on("link", ({ link }) => bar.link(link));
  overlays.onChange(() => {
    timeline.refresh();
    redraw();
  });
  stage.onFrame(() => session.takeNewest());
  stage.onFrame(() => companions.takeNewest());
  stage.onFrame(() => timeline.flush());
  stage.onFrame(() => labels.place(stage.eye));
  // For tests: what is drawn, without reading pixels.
  Object.assign(window, { viewer: { session, stage, timeline, target, robot, companions, models, mark, selection, distances, collisions, map, project: (at: number[]) => new Vector3(at[0], at[1], at[2]).project(stage.eye).toArray() } });
}

try {
  start();
} catch (error) {
  page.banner.hidden = false;
  page.banner.append(
    h("p", {}, h("b", {}, "The view cannot be displayed. "), "WebGL 2 is not available: enable hardware acceleration, or use another browser. ", h("span", { class: "note" }, String(error))),
  );
}
