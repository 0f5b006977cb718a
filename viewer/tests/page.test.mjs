/** The page beside the robot: lost servers, the recorder, addresses, theme, keyboard. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  apart, browserOfFile, enter, launch, moveTarget, openPanel, picture, saved, scene, served, showOverlay, state, until, untilNear, untilReached,
} from "./lib.mjs";

const { look, visit } = browserOfFile();

test("a stopped server is shown, and reconnected to with all that was chosen", () =>
  visit(["panda"], async (page, first) => {
    await enter(page.getByLabel("panda_joint2 as a number"), -0.3);
    await until(page, "Math.abs(state.q[1] + 0.3) < 1e-9");
    await page.getByLabel("Frame", { exact: true }).selectOption("flange");
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await until(page, 'scene.frame === "flange" && scene.task.name === "position"');
    await page.getByLabel("Inverse", { exact: true }).selectOption("damped");
    await until(page, 'scene.method.name === "damped"');
    await showOverlay(page, "velocity-ellipsoid");
    await openPanel(page, "distances");
    await openPanel(page, "obstacles");
    await page.getByRole("button", { name: "Add", exact: true }).click();
    await until(page, "scene.obstacles.length === 1");
    await page.getByRole("switch", { name: "Avoid collisions" }).check();
    await until(page, "scene.avoidance !== null && state.obstacles.length === 1 && state.distances !== null");
    await page.getByRole("button", { name: "Pause" }).click();
    await moveTarget(page, "z", 0.1);
    await until(page, "!state.playing");
    const [was, chosen] = [await state(page), await scene(page)];
    await first.stop();
    await page.getByText("The server has stopped.").waitFor();
    await page.locator('.status[data-state="lost"]').waitFor();
    await picture(page, "server-stopped");
    // The page holds on to its last state until one of the new server is there.
    await page.evaluate(() => Object.assign(window, { last: /** @type {any} */ (window).viewer.session.state }));
    await served(["panda", "--port", new URL(first.url).port], async () => {
      await page.locator('.status[data-state="open"]').waitFor();
      await page.getByText("The server has stopped.").waitFor({ state: "hidden" });
      await until(page, `state !== window.last && Math.abs(state.q[1] + 0.3) < 1e-6 && state.target.position[2] === ${was.target.position[2]}`);
      await until(page, 'state.overlays["velocity-ellipsoid"] !== undefined && state.distances !== null');
      const [is, now] = [await state(page), await scene(page)];
      assert.ok(apart(is.q, was.q) < 1e-12);
      for (const part of /** @type {const} */ (["position", "quaternion"])) assert.ok(apart(is.target[part], was.target[part]) < 1e-12, part);
      assert.equal(is.playing, false);
      assert.deepEqual(is.obstacles, was.obstacles);
      for (const part of /** @type {const} */ (["frame", "task", "method", "obstacles", "avoidance"])) assert.deepEqual(now[part], chosen[part], part);
      await picture(page, "server-restarted");
    });
  }, { width: 1280, height: 720, expect: /WebSocket|net::ERR_/ }));

test("a page that draws slowly is sent no queue of old states", () =>
  visit(["panda"], async (page) => {
    await page.evaluate(() => {
      /** @type {any} */
      const { session, stage } = /** @type {any} */ (window).viewer;
      /** @type {{ drawn: number[], came: number }} */
      const counts = { drawn: [], came: 0 };
      Object.assign(window, { counts });
      session.on("raw", () => (counts.came += 1));
      session.on("state", (/** @type {any} */ state) => counts.drawn.push(state.seq));
      stage.onFrame(() => {
        const end = performance.now() + 200;
        while (performance.now() < end);
      });
    });
    await untilReached(page, await moveTarget(page, "z", -0.25));
    const { drawn, came } = await page.evaluate(() => /** @type {any} */ (window).counts);
    assert.ok(came <= 2 * drawn.length + 2, `${came} states came, ${drawn.length} were drawn`);
    assert.ok(drawn.at(-1) - drawn[0] > 2 * drawn.length, "states between those drawn are left out");
  }));

test("the recorder gives every state as JSON and as CSV, and a PNG of the view", () =>
  visit(["panda"], async (page) => {
    await page.getByRole("button", { name: "Record" }).click();
    await untilReached(page, await moveTarget(page, "x", 0.05));
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const json = JSON.parse(await saved(page, "Save the recording as JSON"));
    assert.equal(json.joint_names.length, 7);
    assert.ok(json.states.length > 5);
    assert.ok(json.states.every((/** @type {any} */ s, /** @type {number} */ i) => i === 0 || s.seq > json.states[i - 1].seq));
    const lines = (await saved(page, "Save the recording as CSV")).trim().split("\r\n");
    assert.equal(lines.length, json.states.length + 1);
    assert.equal(lines[0]?.split(",")[1], json.joint_names[0]);
    assert.equal(Number(lines[1]?.split(",")[0]), json.times[0]);
    const picture = await saved(page, "Save a picture", "latin1");
    assert.equal(picture.slice(1, 4), "PNG");
  }));

test("an address carries the configuration, overlays and camera; a foreign one is refused in words", () =>
  served(["panda"], async ({ url }) => {
    let address = "";
    /** @type {number[]} */
    let q = [];
    /** @type {number[]} */
    let camera = [];
    await look(url, async (page) => {
      await enter(page.getByLabel("panda_joint6 as a number"), 2.1);
      await until(page, "Math.abs(state.q[5] - 2.1) < 1e-9");
      await showOverlay(page, "joint-axes");
      await page.getByRole("button", { name: "top" }).click();
      await page.getByRole("button", { name: /Copy a link/ }).click();
      await page.waitForFunction(() => location.hash.includes("q="));
      [address, q, camera] = [page.url(), (await state(page)).q, await eye(page)];
    });
    await look(address, async (page) => {
      await untilNear(page, "state.q", q, 1e-6);
      await until(page, 'state.overlays["joint-axes"] !== undefined');
      assert.ok(apart(await eye(page), camera) < 1e-6);
    });
    await look(`${url}#model=ur5e&q=0,0,0,0,0,0`, (page) => page.getByText("The address is for ur5e").waitFor());
    await look(`${url}#q=one,two`, (page) => page.getByText("does not contain a valid configuration").waitFor());
  }));

/**
 * @param {import("playwright-core").Page} page
 * @returns {Promise<number[]>}
 */
function eye(page) {
  return page.evaluate(() => /** @type {any} */ (window).viewer.stage.camera.position.toArray());
}

test("a browser without WebGL is told what is missing", () =>
  served(["panda"], async ({ url }) => {
    const bare = await launch("--disable-3d-apis");
    try {
      const page = await bare.newPage();
      await page.goto(url);
      await page.getByText("The view cannot be displayed.").waitFor();
    } finally {
      await bare.close();
    }
  }));

test("everything is reached by the keyboard and has a name; the theme is kept", () =>
  visit(["five-bar"], async (page) => {
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select")]
        .filter((element) => !element.getAttribute("aria-label") && !element.textContent?.trim() && !(/** @type {HTMLInputElement} */ (element).labels?.length))
        .map((element) => element.outerHTML.slice(0, 80)));
    assert.deepEqual(nameless, []);
    const reached = new Set();
    for (let i = 0; i < 60; i += 1) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => {
        const element = document.activeElement;
        return element?.getAttribute("data-actuator") ?? element?.getAttribute("data-joint") ?? element?.getAttribute("data-overlay") ?? element?.tagName ?? "";
      }));
    }
    for (const name of ["q1", "q5", "velocity-ellipsoid", "cylindroid", "CANVAS", "SUMMARY", "SELECT"]) assert.ok(reached.has(name), `${name} is not reached by Tab: ${[...reached]}`);

    const theme = () => page.evaluate(() => document.documentElement.dataset["theme"]);
    assert.equal(await theme(), "light");
    assert.ok((await drawnColours(page)).has("35495e"), "actuated joints as the style sheet has them by day");
    await page.getByRole("button", { name: /^Theme/ }).click();
    await page.getByRole("button", { name: "Theme: light" }).click();
    assert.equal(await theme(), "dark");
    assert.ok((await drawnColours(page)).has("3f6686"), "actuated joints as the style sheet has them by night");
    await page.reload();
    await page.waitForFunction(() => document.documentElement.dataset["theme"] === "dark");
  }));

/**
 * Colours of the robot's bodies, six hexadecimal digits each.
 * @param {import("playwright-core").Page} page
 */
async function drawnColours(page) {
  return new Set(await page.evaluate(() => {
    /** @type {string[]} */
    const colours = [];
    /** @type {any} */ (window).viewer.robot.group.traverse((/** @type {any} */ part) => {
      if (part.material) colours.push(part.material.color.getHexString());
    });
    return colours;
  }));
}
