/** Undo and redo, and the two projections of the view. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, browserOfFile, drag, enter, moveTarget, picture, served, state, until, untilNear, untilReached } from "./lib.mjs";

const { look, visit } = browserOfFile();

/** @param {import("playwright-core").Page} page */
async function moment(page) {
  const { q, target } = await state(page);
  return { q, place: target.position };
}

/**
 * @param {import("playwright-core").Page} page
 * @param {{ q: number[], place: number[] }} wanted
 * @param {number} [tolerance] of the coordinates: near a target the servo goes on
 */
async function untilBack(page, { q, place }, tolerance = 1e-12) {
  await untilNear(page, "state.q", q, tolerance);
  await untilNear(page, "state.target.position", place, 1e-12);
}

test("joints, targets and frames are undone and redone one by one, by buttons and keys", () =>
  visit(["panda"], async (page) => {
    const [undo, redo] = ["Undo", "Redo"].map((name) => page.getByRole("button", { name: new RegExp(`^${name}`) }));
    if (!undo || !redo) throw new Error("no buttons");
    assert.equal(await undo.getAttribute("aria-disabled"), "true");
    const home = await moment(page);
    await enter(page.getByLabel("panda_joint2 as a number"), -0.3);
    await until(page, "Math.abs(state.q[1] + 0.3) < 1e-9");
    const bent = await moment(page);
    await page.waitForTimeout(800); // what follows at once belongs to the same
    await untilReached(page, await moveTarget(page, "z", -0.1));
    await page.waitForTimeout(800);
    const low = await moment(page);
    await page.getByLabel("Frame", { exact: true }).selectOption("link5");
    await until(page, 'scene.frame === "link5"');
    await undo.click();
    await until(page, 'scene.frame !== "link5"');
    await untilBack(page, low, 1e-3);
    await undo.click();
    await untilBack(page, bent);
    await page.locator("canvas").focus();
    await page.keyboard.press("Control+z");
    await untilBack(page, home);
    assert.equal(await undo.getAttribute("aria-disabled"), "true");
    await page.keyboard.press("Control+Shift+Z");
    await untilBack(page, bent);
    await redo.focus();
    await page.keyboard.press("Enter");
    await untilBack(page, low, 1e-3);
    assert.ok(await redo.evaluate((element) => element === document.activeElement), "the focus stays");
    await undo.click();
    await untilBack(page, bent);
    // Something new ends the redoing.
    await page.waitForTimeout(800);
    await enter(page.getByLabel("panda_joint1 as a number"), 0.2);
    await until(page, "Math.abs(state.q[0] - 0.2) < 1e-9");
    assert.equal(await redo.getAttribute("aria-disabled"), "true");
    // In a field the key undoes typing.
    await page.getByLabel("panda_joint1 as a number").focus();
    await page.keyboard.press("Control+z");
    await page.waitForTimeout(200);
    assert.ok(Math.abs(((await state(page)).q[0] ?? 0) - 0.2) < 1e-9);
  }));

test("a drag is one step of the history, and closed loops come back closed", () =>
  visit(["five-bar"], async (page) => {
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await until(page, 'scene.task.components.join() === "x,y"');
    const before = await moment(page);
    await untilReached(page, await drag(page, [0, -0.4, 0]));
    const undo = page.getByRole("button", { name: /^Undo/ });
    await undo.click();
    await untilBack(page, before);
    assert.equal(await undo.getAttribute("aria-disabled"), "true");
    assert.ok((await state(page)).closure_error?.closed);
  }));

test("two strokes on a slider are two steps however fast, a slow one is one", () =>
  visit(["panda"], async (page) => {
    const before = await moment(page);
    const box = await page.locator('[data-joint="panda_joint1"]').boundingBox();
    if (!box) throw new Error("no slider");
    const at = (/** @type {number} */ share) => /** @type {const} */ ([box.x + share * box.width, box.y + box.height / 2]);
    await page.mouse.move(...at(0.5));
    await page.mouse.down();
    await page.mouse.move(...at(0.51));
    await page.waitForTimeout(900);
    await page.mouse.move(...at(0.52));
    await page.mouse.up();
    await untilSlider(page);
    const first = await moment(page);
    await page.mouse.down();
    await page.mouse.move(...at(0.54));
    await page.mouse.up();
    await until(page, `state.q[0] > ${first.q[0]} + 0.05`);
    const undo = page.getByRole("button", { name: /^Undo/ });
    await undo.click();
    await untilNear(page, "state.q", first.q, 1e-12);
    await undo.click();
    await untilBack(page, before);
  }));

/**
 * Waits until the robot is where the first slider is.
 * @param {import("playwright-core").Page} page
 */
async function untilSlider(page) {
  const value = Number(await page.locator('[data-joint="panda_joint1"]').inputValue());
  assert.ok(value > 0.05);
  await untilNear(page, "[state.q[0]]", [value], 1e-9);
}

/**
 * Where points are seen, from -1 to 1.
 * @param {import("playwright-core").Page} page
 * @param {number[][]} points
 * @returns {Promise<number[][]>}
 */
async function seen(page, points) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return page.evaluate((all) => all.map((point) => /** @type {any} */ (window).viewer.project(point).slice(0, 2)), points);
}

test("orthographic: equal lengths are seen equal at every depth; the view keeps its direction and size", () =>
  visit(["panda"], async (page) => {
    const corners = [0, 1].flatMap((depth) => [[0, -depth, 0], [0.3, -depth, 0], [0, -depth, 0.3]]);
    const edges = (/** @type {number[][]} */ all) => [0, 3].map((i) => [1, 2].map((k) => apart(all[i] ?? [], all[i + k] ?? [])));
    await page.getByRole("button", { name: "front" }).click();
    const [near, far] = edges(await seen(page, corners));
    assert.ok(apart(near ?? [], far ?? []) > 0.05, "with perspective what is near is larger");
    const centre = await page.evaluate(() => /** @type {any} */ (window).viewer.stage.orbit.target.toArray());
    const up = [centre[0], centre[1], centre[2] + 0.1];
    const before = await seen(page, [centre, up]);
    await page.locator("canvas").focus();
    await page.keyboard.press("o");
    await page.getByRole("button", { name: "orthographic", pressed: true }).waitFor();
    const [first, second] = edges(await seen(page, corners));
    assert.ok(apart(first ?? [], second ?? []) < 1e-9, `${first} ${second}`);
    const after = await seen(page, [centre, up]);
    assert.ok(apart(before.flat(), after.flat()) < 1e-3, "the size at the centre stays");
    // Turned, zoomed and dragged as before.
    await page.keyboard.press("+");
    const [, closer = []] = await seen(page, [centre, up]);
    assert.ok(Math.abs((closer[1] ?? 0) - 1.15 * (after[1]?.[1] ?? 0)) < 1e-2);
    await untilReached(page, await drag(page, [0, 0, -0.1]));
    await picture(page, "orthographic");
  }));

test("planar mechanisms are seen in their plane, and an address keeps the projection", () =>
  served(["five-bar"], async ({ url }) => {
    let address = "";
    await look(url, async (page) => {
      const button = page.getByRole("button", { name: "orthographic" });
      assert.equal(await button.getAttribute("aria-pressed"), "true");
      const [a = [], b = [], c = []] = await seen(page, [[0, 0, 0], [1, 0, 0], [1, 0, 0.5]]);
      assert.ok(apart(b, c) < 1e-3 && Math.abs((a[1] ?? 0) - (b[1] ?? 1)) < 1e-6, "x points to the right, z at the eye");
      await button.click();
      await page.getByRole("button", { name: /Copy a link/ }).click();
      await page.waitForFunction(() => location.hash.includes("projection=perspective"));
      address = page.url();
    });
    await look(address, async (page) => {
      await page.getByRole("button", { name: "orthographic", pressed: false }).waitFor();
    });
  }));
