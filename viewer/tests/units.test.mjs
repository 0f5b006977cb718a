/** Units of display: millimetres, degrees, roll, pitch and yaw; what is sent stays SI. Orientations are typed, frames searched. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { apart, browserOfFile, cylindroid, enter, openPanel, picture, ROBOTS, scene, state, until, untilNear } from "./lib.mjs";

const { visit } = browserOfFile();

const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));
const TURN = 180 / Math.PI;

/**
 * @param {import("playwright-core").Page} page
 * @param {{ Length?: string, Angle?: string, Orientation?: string }} units
 */
async function choose(page, units) {
  const panel = await openPanel(page, "units");
  for (const [label, name] of Object.entries(units)) await panel.getByLabel(label, { exact: true }).selectOption(name);
}

/**
 * Numbers in fields.
 * @param {import("playwright-core").Page} page
 * @param {string[]} selectors
 */
const shown = (page, selectors) => Promise.all(selectors.map(async (selector) => Number(await page.locator(selector).inputValue())));

const RPY = ["roll", "pitch", "yaw"];

test("millimetres, degrees, roll, pitch and yaw are those of fk; a choice sends nothing and is kept", () =>
  visit(["panda", "--q=0.3,0.2,0.1,-1.2,0.3,1.4,0.5"], async (page) => {
    const { pose } = await cylindroid("fk", "panda", "--q=0.3,0.2,0.1,-1.2,0.3,1.4,0.5");
    const before = await state(page);
    await page.evaluate(() => {
      const { session } = /** @type {any} */ (window).viewer;
      const send = session.send.bind(session);
      Object.assign(window, { sent: [] });
      session.send = (/** @type {any} */ message) => {
        /** @type {any} */ (window).sent.push(message.type);
        return send(message);
      };
    });
    await choose(page, { Length: "mm", Angle: "deg", Orientation: "roll, pitch, yaw" });
    assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).sent), []);
    const check = async () => {
      const target = await shown(page, ["x", "y", "z", ...RPY].map((name) => `[data-target="${name}"]`));
      assert.ok(apart(target.slice(0, 3), pose.position.map((/** @type {number} */ x) => 1000 * x)) < 0.0501, `${target}`);
      assert.ok(apart(target.slice(3), pose.rpy.map((/** @type {number} */ x) => TURN * x)) < 0.00501, `${target}`);
      const row = (/** @type {string} */ name) => page.locator("tr", { has: page.locator(`[data-pose="${name}"]`) }).locator("td").first().innerText();
      const cells = await Promise.all([..."xyz", ...RPY].map(async (name) => Number((await row(name)).replace("−", "-"))));
      assert.ok(apart(cells.slice(0, 3), pose.position.map((/** @type {number} */ x) => 1000 * x)) < 0.00501, `${cells}`);
      assert.ok(apart(cells.slice(3), pose.rpy.map((/** @type {number} */ x) => TURN * x)) < 0.000501, `${cells}`);
      const joint = Number(await page.getByLabel("panda_joint4 as a number [deg]").inputValue());
      assert.ok(Math.abs(joint + 1.2 * TURN) < 0.00501);
    };
    await check();
    await picture(page, "units");
    await page.reload();
    await until(page, "state.q.length === 7");
    await check();
    assert.ok(apart((await state(page)).q, before.q) < 1e-12);
  }, { width: 1366, height: 1400 }));

test("values typed in display units arrive in SI", () =>
  visit([CELL], async (page) => {
    await choose(page, { Length: "mm", Angle: "deg", Orientation: "roll, pitch, yaw" });
    const { joints, coordinates } = await scene(page);
    const name = coordinates[0]?.name ?? "";
    assert.ok(joints.length > 0 && coordinates[0]?.unit === "rad");
    await enter(page.getByLabel(`${name} as a number [deg]`), 12.5);
    await untilNear(page, "[state.q[0]]", [12.5 / TURN], 1e-12);
    const panel = await openPanel(page, "obstacles");
    await enter(panel.getByLabel("Radius of the new sphere (mm)"), 125);
    await panel.getByRole("button", { name: "Add" }).click();
    await until(page, "scene.obstacles.length === 1 && Math.abs(scene.obstacles[0].radius - 0.125) < 1e-12 && state.obstacles.length === 1");
    await enter(panel.getByLabel("z of sphere 1 in the world frame (mm)"), 812.5);
    await until(page, "Math.abs(state.obstacles[0].position[2] - 0.8125) < 1e-12");
    await enter(panel.getByLabel("Least distance (mm)"), 25);
    await panel.getByRole("switch", { name: "Avoid collisions" }).check();
    await until(page, "Math.abs(scene.avoidance?.gap - 0.025) < 1e-12");
    await openPanel(page, "distances");
    await enter(page.getByLabel("Only pairs closer than this (mm)"), 750);
    await until(page, "Math.abs(state.distances?.margin - 0.75) < 1e-12");
  }));

test("an orientation of the target is typed as angles and as a quaternion, and reached", () =>
  visit(["panda", "--q=0.3,0.2,0.1,-1.2,0.3,1.4,0.5"], async (page) => {
    await choose(page, { Angle: "deg", Orientation: "roll, pitch, yaw" });
    const { target: { position }, q } = await state(page);
    const { pose } = await cylindroid("fk", "panda", `--q=${q.join(",")}`);
    await enter(page.getByLabel("Target yaw in the world frame (deg)"), 50);
    await until(page, 'state.servo.status === "reached" && Math.abs(state.q[6] - 0.5) > 0.01 && state.error.orientation < 1e-3');
    const now = await state(page);
    const { pose: turned } = await cylindroid("fk", "panda", `--q=${now.q.join(",")}`);
    assert.ok(apart(turned.rpy, [pose.rpy[0], pose.rpy[1], 50 / TURN]) < 2e-3, `${turned.rpy}`);
    assert.ok(apart(now.target.position, position) < 1e-9, "the position stays");
    await choose(page, { Orientation: "quaternion" });
    // Any length but zero: the server makes it one.
    for (const [i, part, value] of /** @type {const} */ ([[0, "qw", 0], [2, "qy", 0], [3, "qz", 0], [1, "qx", 2]])) {
      await enter(page.getByLabel(`Target ${part} in the world frame`), value);
      await until(page, `Math.abs(Math.abs(state.target.quaternion[${i}]) - ${value && 1}) < 1e-9`);
    }
    await untilNear(page, "state.target.quaternion.map(Math.abs)", [0, 1, 0, 0]);
  }));

test("an orientation of a box is typed; a sphere has none", () =>
  visit([CELL, "--obstacle", "box=box:0.1,0.2,0.3@0.7,0.6,0.3", "--obstacle", "ball=sphere:0.08@0.4,0.9,0.3"], async (page) => {
    await choose(page, { Angle: "deg", Orientation: "roll, pitch, yaw" });
    await openPanel(page, "obstacles");
    const yaw = page.getByLabel("yaw of box in the world frame (deg)");
    await page.waitForFunction((field) => field instanceof HTMLInputElement && field.value === "0.00", await yaw.elementHandle());
    await enter(yaw, 90);
    const half = Math.sqrt(0.5);
    await until(page, `Math.abs(state.obstacles[0].quaternion[0] - ${half}) < 1e-9 && Math.abs(state.obstacles[0].quaternion[3] - ${half}) < 1e-9`);
    assert.equal(await page.getByLabel("yaw of ball").count(), 0);
  }));

test("frames of a long list are searched by the keyboard", () =>
  visit([`${ROBOTS}/panda_description/urdf/panda.urdf`], async (page) => {
    const { frames } = await scene(page);
    assert.ok(frames.length > 12);
    const search = page.getByLabel("Search frame");
    await search.fill("LINK5");
    const found = frames.filter(({ name }) => name.includes("link5")).map(({ name }) => name);
    assert.equal(found.length, 1);
    const list = page.getByLabel("Frame", { exact: true });
    const { frame } = await scene(page);
    assert.deepEqual((await list.locator("option").allInnerTexts()).sort(), [...found, frame].sort());
    await page.getByText("1 of ").waitFor();
    await search.press("Enter");
    await until(page, `scene.frame === "${found[0]}"`);
    assert.equal(await list.inputValue(), found[0]);
    assert.equal(await list.locator("option").count(), frames.length);
    await search.fill("no such frame");
    await page.getByText(`0 of ${frames.length}`).waitFor();
    await search.press("Enter");
    await search.press("Escape");
    assert.equal(await search.inputValue(), "");
    assert.equal((await scene(page)).frame, found[0]);
  }));

test("limits of sliders are shown to five digits", () =>
  visit(["panda"], async (page) => {
    const shownLimits = await page.locator(".joint .limit").allInnerTexts();
    const { coordinates } = await scene(page);
    const numbers = shownLimits.map((words) => Number(words.replace("−", "-")));
    assert.ok(apart(numbers, coordinates.flatMap(({ lower, upper }) => [lower ?? 0, upper ?? 0])) < 5e-5, `${shownLimits}`);
    assert.ok(shownLimits.includes("−0.0175"), `${shownLimits}`);
  }));
