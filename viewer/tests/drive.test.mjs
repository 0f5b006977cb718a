/** An arm is moved: by a slider, by its target, by the null space, by the keyboard; numbers agree with the command line. */
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  apart, browserOfFile, cylindroid, drag, drawn, enter, moveTarget, openPanel, scene, state, until, untilNear, untilReached,
} from "./lib.mjs";

const { visit } = browserOfFile();

/** @param {import("playwright-core").Page} page */
async function shownPose(page) {
  const values = await page.locator("[data-pose]").evaluateAll((all) => all.map((element) => [element.getAttribute("data-pose"), Number(element.getAttribute("data-value"))]));
  const shown = Object.fromEntries(values);
  return [shown.x, shown.y, shown.z, shown.qw, shown.qx, shown.qy, shown.qz];
}

test("a slider moves the arm, and the pose panel agrees with fk", () =>
  visit(["panda"], async (page) => {
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
  }));

test("a slider moves by the keyboard, and keeps its limits", () =>
  visit(["panda"], async (page) => {
    const slider = page.locator('[data-joint="panda_joint1"]');
    await slider.focus();
    for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
    await until(page, "state.q[0] > 0.1 && state.q[0] < 0.2");
    await enter(page.getByLabel("panda_joint1 as a number"), 99);
    await page.locator(".toast.bad").waitFor();
    const { coordinates } = await scene(page);
    assert.ok(((await state(page)).q[0] ?? 0) <= (coordinates[0]?.upper ?? 0));
  }));

test("the target is dragged by its handle, and the servo converges", () =>
  visit(["panda"], async (page) => {
    const before = await state(page);
    await page.getByRole("button", { name: "front" }).click();
    const place = await drag(page, [0, 0, -0.12]);
    await untilReached(page, place);
    const now = await state(page);
    assert.ok(now.target.position[2] < before.target.position[2] - 0.05);
    assert.ok(apart(now.target.position.slice(0, 2), before.target.position.slice(0, 2)) < 1e-6, "the arrow along z moves along z alone");
  }));

test("a target typed in is reached; pause, play and reset", () =>
  visit(["panda"], async (page) => {
    const home = (await state(page)).q;
    await page.getByRole("button", { name: "Pause" }).click();
    await until(page, "!state.playing");
    const target = await moveTarget(page, "z", -0.1);
    await until(page, `Math.abs(state.target.position[2] - ${target[2]}) < 1e-9`);
    const { time } = await state(page);
    await page.waitForTimeout(300);
    // Another message, whose state is newer than the wait.
    await page.getByLabel("Inverse", { exact: true }).selectOption("damped");
    await until(page, 'scene.method.name === "damped"');
    assert.ok((await state(page)).time === time && apart((await state(page)).q, home) < 1e-12, "a paused servo rests");
    await page.getByRole("button", { name: "Play" }).click();
    await until(page, "state.playing");
    await untilReached(page, target);
    const { q, tool } = await state(page);
    assert.ok(apart(tool.position.slice(2), target.slice(2)) < 1e-3);
    assert.ok(apart(q, home) > 0.01);
    await page.getByRole("button", { name: "Reset" }).click();
    await untilNear(page, "state.q", home, 1e-12);
  }));

test("the null-space slider moves the joints and holds the tool", () =>
  visit(["panda"], async (page) => {
    const before = await state(page);
    const slider = page.getByLabel("Self-motion: share");
    await slider.focus();
    for (let i = 0; i < 4; i += 1) await page.keyboard.press("ArrowRight");
    await until(page, `state.servo.self_motion !== 0 && Math.max(...state.q.map((value, i) => Math.abs(value - [${before.q}][i]))) > 0.15`);
    await page.locator("body").click({ position: { x: 5, y: 5 } });
    await slider.blur();
    await until(page, "state.servo.self_motion === 0");
    const now = await state(page);
    assert.ok(apart(now.tool.position, before.tool.position) < 2e-3);
    assert.equal(await slider.inputValue(), "0");
  }));

test("held keys and buttons move the tool, and it brakes when they are let go", () =>
  visit(["panda"], async (page) => {
    const before = await state(page);
    const pad = page.getByRole("group", { name: /^Hold to move/ });
    await pad.focus();
    await page.keyboard.down("PageDown");
    await until(page, `state.tool.position[2] < ${before.tool.position[2]} - 0.02 && state.servo.twist !== null`);
    assert.match((await state(page)).servo.sentence, /Following the commanded twist/);
    assert.match(await pad.innerText(), /commanded .* m\/s/);
    await page.keyboard.up("PageDown");
    await until(page, 'state.servo.twist === null && state.servo.status === "reached"');
    const low = await state(page);
    assert.ok(apart(low.tool.position, low.target.position) < 1e-9, "the target is at the tool again");
    assert.ok(apart(low.tool.position.slice(0, 2), before.tool.position.slice(0, 2)) < 1e-3);
    await page.keyboard.down("Shift");
    await page.keyboard.down("ArrowRight");
    await until(page, `Math.abs(state.tool.quaternion[0] - ${low.tool.quaternion[0]}) > 0.02`);
    await page.keyboard.up("Shift");
    await page.keyboard.up("ArrowRight");
    await until(page, 'state.servo.twist === null && state.servo.status === "reached"');
    const turned = await state(page);
    assert.ok(apart(turned.tool.position, low.tool.position) < 2e-3, "rotation leaves the tool point in place");
    const button = page.getByRole("button", { name: "Move +y" });
    await button.hover();
    await page.mouse.down();
    await until(page, `state.tool.position[1] > ${turned.tool.position[1]} + 0.02`);
    await page.mouse.up();
    await until(page, 'state.servo.twist === null && state.servo.status === "reached"');
    // A lost key-up stops it as well: the page sends no more.
    await pad.focus();
    await page.keyboard.down("ArrowUp");
    await until(page, "state.servo.twist !== null");
    await page.evaluate(() => /** @type {HTMLElement} */ (document.activeElement).blur());
    await until(page, 'state.servo.twist === null && state.servo.status === "reached"');
    await page.keyboard.up("ArrowUp");
  }));

test("frame, task and inverse are chosen; the handle offers what the task minds", () =>
  visit(["panda"], async (page) => {
    await page.getByLabel("Frame", { exact: true }).selectOption("link5");
    await until(page, 'scene.frame === "link5"');
    const { pose } = await cylindroid("fk", "panda", "--frame", "link5");
    await untilNear(page, "state.tool.position", pose.position);
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await until(page, 'scene.task.components.join() === "x,y,z"');
    assert.ok(await page.getByRole("button", { name: "Rotate" }).isDisabled());
    await page.getByLabel("Inverse", { exact: true }).selectOption("damped");
    await enter(page.getByLabel(/^damping/), 0.07);
    await until(page, "scene.method.parameters.damping === 0.07");
  }));

test("two inverses side by side: one changes with the reference point, the hyperbolic one does not", () =>
  visit(["ur5e"], async (page) => {
    const panel = await openPanel(page, "compare");
    await panel.getByLabel("First inverse").selectOption("damped");
    await panel.locator("table").waitFor();
    await page.waitForFunction(() => /damped: depends on the point/.test(document.querySelector('[data-panel="compare"]')?.textContent ?? ""));
    assert.match(await panel.innerText(), /hyperbolic: independent of the point/);
  }));

test("at rest the page draws no frames", () =>
  visit(["panda"], async (page) => {
    await until(page, 'state.servo.status === "reached"');
    await page.waitForTimeout(500);
    const frames = () => page.evaluate(() => /** @type {any} */ (window).viewer.stage.frames);
    const first = await frames();
    await page.waitForTimeout(700);
    assert.ok((await frames()) - first <= 1);
    await drawn(page);
  }));
