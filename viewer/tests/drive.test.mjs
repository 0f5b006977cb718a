/** An arm is driven: by a slider, by its target, by the null space, by the keyboard; numbers agree with the command line. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { apart, cylindroid, drag, drawn, launch, open, openPanel, scene, serve, state, until } from "./lib.mjs";

/** @type {import("playwright-core").Browser} */
let browser;
/** @type {Awaited<ReturnType<typeof serve>>} */
let server;
before(async () => {
  browser = await launch();
  server = await serve("panda");
});
after(async () => {
  await browser.close();
  await server.stop();
});

/** @param {import("playwright-core").Page} page */
async function shownPose(page) {
  const values = await page.locator("[data-pose]").evaluateAll((all) => all.map((element) => [element.getAttribute("data-pose"), Number(element.getAttribute("data-value"))]));
  const shown = Object.fromEntries(values);
  return [shown.x, shown.y, shown.z, shown.qw, shown.qx, shown.qy, shown.qz];
}

test("a slider moves the arm, and the pose panel agrees with fk", async () => {
  const { page, troubles, close } = await open(browser, server.url);
  const before = await state(page);
  const slider = page.locator('[data-joint="panda_joint4"]');
  await slider.evaluate((element) => {
    const input = /** @type {HTMLInputElement} */ (element);
    input.value = "-1.2";
    input.dispatchEvent(new Event("input"));
  });
  await until(page, "Math.abs(state.q[3] + 1.2) < 1e-12");
  const now = await state(page);
  assert.notDeepEqual(now.links, before.links);
  const { pose } = await cylindroid("fk", "panda", "--frame", (await scene(page)).frame, `--q=${now.q.join(",")}`);
  const { w, x, y, z } = pose.quaternion;
  assert.ok(apart(await shownPose(page), [...pose.position, w, x, y, z]) < 1e-9);
  assert.deepEqual(troubles, []);
  await close();
});

test("a slider moves by the keyboard, and keeps its limits", async () => {
  const { page, close } = await open(browser, server.url);
  const slider = page.locator('[data-joint="panda_joint1"]');
  await slider.focus();
  for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
  await until(page, "state.q[0] > 0.1 && state.q[0] < 0.2");
  const field = page.getByLabel("panda_joint1 as a number");
  await field.fill("99");
  await field.press("Enter");
  await page.locator(".toast.bad").waitFor();
  const { coordinates } = await scene(page);
  assert.ok(((await state(page)).q[0] ?? 0) <= (coordinates[0]?.upper ?? 0));
  await close();
});

test("the target is dragged by its handle, and the servo converges", async () => {
  const { page, troubles, close } = await open(browser, server.url);
  const before = await state(page);
  await page.getByRole("button", { name: "front" }).click();
  await drag(page, [0, 0, -0.12]);
  await until(page, `state.target.position[2] < ${(before.target.position[2] ?? 0) - 0.05}`);
  await until(page, 'state.servo.status === "reached" && state.error.position < 1e-3 && state.error.orientation < 1e-3');
  const now = await state(page);
  assert.ok(apart(now.target.position.slice(0, 2), before.target.position.slice(0, 2)) < 1e-6, "the arrow along z moves along z alone");
  assert.deepEqual(troubles, []);
  await close();
});

test("a target typed in is reached; pause, play and reset", async () => {
  const { page, close } = await open(browser, server.url);
  const home = (await state(page)).q;
  const { position } = (await state(page)).target;
  await page.getByRole("button", { name: "Pause" }).click();
  await until(page, "!state.playing");
  const field = page.locator('[data-target="z"]');
  await field.fill(String((position[2] ?? 0) - 0.1));
  await field.press("Enter");
  await until(page, `Math.abs(state.target.position[2] - ${(position[2] ?? 0) - 0.1}) < 1e-6`);
  assert.ok(apart((await state(page)).q, home) < 1e-12, "a paused servo rests");
  await page.getByRole("button", { name: "Play" }).click();
  await until(page, `state.servo.status === "reached" && state.playing && Math.abs(state.tool.position[2] - ${(position[2] ?? 0) - 0.1}) < 1e-3`);
  await page.getByRole("button", { name: "Reset" }).click();
  await until(page, `Math.abs(state.q[1] - ${home[1]}) < 1e-12`);
  await close();
});

test("the null-space slider moves the joints and holds the tool", async () => {
  const { page, close } = await open(browser, server.url);
  const before = await state(page);
  const slider = page.getByLabel("Self-motion: rate");
  await slider.focus();
  for (let i = 0; i < 4; i += 1) await page.keyboard.press("ArrowRight");
  await until(page, `Math.max(...state.q.map((value, i) => Math.abs(value - [${before.q}][i]))) > 0.15`);
  await page.locator("body").click({ position: { x: 5, y: 5 } });
  await slider.blur();
  await until(page, "state.servo.self_motion === 0");
  const now = await state(page);
  assert.ok(apart(now.tool.position, before.tool.position) < 2e-3);
  assert.equal(await slider.inputValue(), "0");
  await close();
});

test("frame, task and inverse are chosen; the handle offers what the task minds", async () => {
  const { page, troubles, close } = await open(browser, server.url);
  await page.getByLabel("Frame", { exact: true }).selectOption("link5");
  await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.frame === "link5");
  const { pose } = await cylindroid("fk", "panda", "--frame", "link5");
  await until(page, `state.tool.position.every((value, i) => Math.abs(value - [${pose.position}][i]) < 1e-9)`);
  await page.getByLabel("Task", { exact: true }).selectOption("position");
  await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.task.components.join() === "x,y,z");
  assert.ok(await page.getByRole("button", { name: "Turn" }).isDisabled());
  await page.getByLabel("Inverse", { exact: true }).selectOption("damped");
  await page.getByLabel("damping", { exact: true }).fill("0.07");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.method.numbers.damping === 0.07);
  assert.deepEqual(troubles, []);
  await close();
});

test("two inverses side by side: one changes with the reference point, the hyperbolic one does not", async () => {
  const server = await serve("ur5e");
  try {
    const { page, troubles, close } = await open(browser, server.url);
    const panel = await openPanel(page, "compare");
    await panel.getByLabel("First inverse").selectOption("damped");
    await panel.locator("table").waitFor();
    await page.waitForFunction(() => /damped: changes by/.test(document.querySelector('[data-panel="compare"]')?.textContent ?? ""));
    assert.match(await panel.innerText(), /hyperbolic: does not change with the point/);
    assert.deepEqual(troubles, []);
    await close();
  } finally {
    await server.stop();
  }
});

test("at rest the page draws no frames", async () => {
  const { page, close } = await open(browser, server.url);
  await until(page, 'state.servo.status === "reached"');
  await page.waitForTimeout(500);
  const frames = () => page.evaluate(() => /** @type {any} */ (window).viewer.stage.frames);
  const first = await frames();
  await page.waitForTimeout(700);
  assert.ok((await frames()) - first <= 1);
  await drawn(page);
  await close();
});
