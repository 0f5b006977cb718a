/** A recording that plays by itself: the page of one HTML file. It has no server, and computes nothing. */
import { Sphere } from "three";
import { Recorded } from "../beside/recorded";
import { isTyping } from "../controls/tools";
import { h } from "../dom";
import { count, fixed } from "../format";
import { icon } from "../icons";
import { layout } from "../layout";
import { Obstacles } from "../obstacles";
import { Overlays } from "../overlays/overlays";
import { posePanel } from "../panels/pose";
import { singularPanel } from "../panels/singular";
import type { Scene } from "../protocol";
import { Robot } from "../robot/robot";
import { Labels } from "../scene/labels";
import { Picking } from "../scene/picking";
import { Stage, type View } from "../scene/stage";
import { nextTheme } from "../theme";
import { Dock } from "../timeline/dock";
import { Player } from "../timeline/player";
import { Plots } from "../timeline/plots";
import { Recording } from "../timeline/recording";
import { Trail } from "../timeline/trail";
import { UnitControls } from "../controls/units";
import { inUnits } from "../units";
import { offer } from "./bodies";
import { BODIES, RECORDING, unpacked, type Head, type Track } from "./film";
import "../styles/film.css";

const VIEWS: View[] = ["corner", "front", "side", "top"];

const root = document.getElementById("app");
if (!root) throw new Error("the page has no element for the viewer");
document.documentElement.toggleAttribute("data-recording", true);
const page = layout(root);

/** What a part of the file says. */
function part(id: string): Response {
  return unpacked(document.getElementById(id)?.textContent ?? "");
}

async function start(): Promise<void> {
  const [first = "", ...states] = (await part(RECORDING).text()).split("\n");
  const head = JSON.parse(first) as Head;
  const scenes = [head, ...head.beside].flatMap((track) => track.scenes.map(({ scene }) => scene));
  await offer(scenes, await part(BODIES).arrayBuffer());
  const recording = recordingOf(head, states);
  for (const { session, ...track } of head.beside) recording.beside.set(session, recordingOf(track, states));
  show(recording, head);
}

/** Takes the states of a model, which are the first of these. */
function recordingOf({ scenes, times }: Track, states: string[]): Recording {
  const [first] = scenes;
  if (!first) throw new Error("it has no scene");
  const recording = new Recording(first.scene);
  states.splice(0, times.length).forEach((raw, i) => {
    const next = scenes.find(({ from }) => from === i && i > 0);
    if (next) recording.changeScene(next.scene);
    recording.take(times[i] ?? 0, raw);
  });
  return recording;
}

function show(recording: Recording, head: Head): void {
  const stage = new Stage(page.stage);
  const labels = new Labels(page.stage);
  let fitWanted = true;
  const robot = new Robot({ changed: () => stage.invalidate(), problems: () => redraw() });
  const overlays = new Overlays(page.legend, labels, () => undefined);
  for (const name of head.overlays) overlays.show(name, true);
  const obstacles = new Obstacles(stage, { picked: () => undefined, problem: (sentence) => page.toast(sentence, true) }, new Picking(stage, () => true));
  const trail = new Trail();
  const [pose, singular] = [posePanel(), singularPanel(() => redraw())];
  page.right.append(pose.element, singular.element, new UnitControls().panel.element);
  const beside = new Recorded(() => stage.invalidate());
  stage.scene.add(robot.group, overlays.group, obstacles.group, trail.group, beside.group);

  const player = new Player(() => move(), () => dock.playing(player.playing));
  const plots = new Plots((time) => {
    player.pause();
    player.seek(time);
  });
  page.plots.append(plots.panel.element);
  let size = 1;
  const dock = new Dock(page.dock, player, {
    trail: (shown) => {
      if (shown) trail.draw(recording.columns, size);
      else trail.clear();
      stage.invalidate();
    },
  });

  let [index, built]: [number, Scene | null] = [0, null];
  const redraw = (): void => {
    const [scene, state] = [recording.sceneAt(index), recording.stateAt(index)];
    if (!state) return;
    if (scene !== built) {
      built = scene;
      robot.build(scene);
      obstacles.build(scene);
    }
    robot.place(state);
    obstacles.place(state, null);
    beside.show({ recording, time: player.time, scene });
    if (fitWanted) fit(scene);
    overlays.draw(scene, state, { size, jointPlace: (coordinate) => robot.jointPlace(scene, coordinate) });
    for (const panel of [pose, singular]) panel.show(scene, state);
    stage.invalidate();
  };
  /** As the page was seen that saved the file. */
  const fit = (scene: Scene): void => {
    fitWanted = false;
    const box = robot.box();
    size = Math.max(2.2 * box.getBoundingSphere(new Sphere()).radius, 0.1 * scene.reach);
    stage.scale(size, scene.dimension === 2 ? -0.03 * size : box.min.z);
    stage.fit(beside.within(box));
    stage.setOrthographic(head.orthographic);
    stage.place(head.camera);
    trail.draw(recording.columns, size);
  };
  const move = (): void => {
    index = recording.columns.indexAt(player.time);
    dock.at(player.time, false);
    plots.at(index, player.time);
    redraw();
  };
  inUnits(page.right, redraw);
  for (const { onToggle } of [pose, singular]) onToggle(redraw);
  stage.onFrame(() => labels.place(stage.eye));

  const all = (): void => stage.fit(beside.within(robot.box()));
  const project = (): void => stage.setOrthographic(!stage.isOrthographic);
  page.bar.append(
    h("h1", { class: "brand" }, "cylindroid"),
    h("div", { class: "model" }, h("b", {}, recording.scene.name), ` ${count(recording.length, "state")}, ${fixed(recording.end, 2)} s`),
    h("div", { class: "spread" }),
    h("button", { class: "button", type: "button", title: "Theme", "aria-label": "Theme", onclick: () => nextTheme() }, icon("system")),
  );
  page.tools.append(
    h("span", { class: "float-row" },
      h("button", { class: "button small", type: "button", title: "Orthographic projection (O)", onclick: project }, "orthographic"),
      h("span", { class: "group", role: "group", "aria-label": "View direction" }, ...VIEWS.map((view) => h("button", { class: "button small", type: "button", onclick: () => stage.view(view) }, view))),
      h("button", { class: "button small", type: "button", title: "Show all (F)", "aria-label": "Show all", onclick: all }, icon("fit"))),
  );
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    if (event.key === "f") all();
    if (event.key === "o") project();
    // A button in focus is pressed by the space bar.
    if (event.key !== " " || event.target instanceof HTMLButtonElement) return;
    event.preventDefault();
    if (player.playing) player.pause();
    else player.play();
  });
  player.setEnd(recording.end);
  dock.show(recording.columns, recording.end);
  dock.paint();
  dock.playing(false);
  plots.show(recording);
  player.seek(0);
  // For tests: what is drawn, without reading pixels.
  Object.assign(window, { film: { recording, stage, robot, beside, player, overlays, state: () => recording.stateAt(index) } });
}

start().catch((error: unknown) => {
  page.banner.hidden = false;
  page.banner.append(h("p", {}, h("b", {}, "The recording cannot be shown. "), error instanceof Error ? error.message : String(error)));
});
