/** Distances of bodies and obstacles: listed, drawn, dragged, avoided. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import {
  apart, browserOfFile, drag, enter, moveTarget, openPanel, picture, scene, served, state, until, untilNear,
} from "./lib.mjs";

const { look, visit } = browserOfFile();

const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));
const BALL = ["--obstacle", "ball=sphere:0.08@0.4,0.25,0.3"];

/**
 * Number of bodies drawn by the panel of distances.
 * @param {import("playwright-core").Page} page
 */
const lines = (page) => page.evaluate(() => /** @type {any} */ (window).viewer.distances.group.children.length);

test("bodies near each other are listed and connected while the panel is open", () =>
  visit([CELL, ...BALL], async (page) => {
    assert.equal((await state(page)).distances, null, "a folded panel costs nothing");
    const panel = await openPanel(page, "distances");
    await until(page, "state.distances !== null");
    const few = (await state(page)).distances?.near.length ?? 0;
    assert.equal(await panel.locator("[data-near]").count(), few);
    assert.equal(await lines(page), 3 * few, "a line and two points for each pair");
    await enter(panel.getByLabel("Only pairs closer than this (m)"), 0.6);
    await until(page, `state.distances.near.length > ${few}`);
    const seen = (await state(page)).distances?.near ?? [];
    const shown = await panel.locator("[data-near]").evaluateAll((all) => all.map((row) => Number(row.getAttribute("data-value"))));
    assert.ok(apart(shown, seen.map((near) => near.distance)) < 1e-12);
    const shapes = () => page.evaluate(() => {
      /** @type {any} */
      const { group } = /** @type {any} */ (window).viewer.collisions;
      return { shown: group.visible, count: group.children.reduce((/** @type {number} */ sum, /** @type {any} */ link) => sum + link.children.length, 0) };
    });
    assert.deepEqual(await shapes(), { shown: false, count: 0 });
    await page.getByRole("switch", { name: "Collision shapes" }).check();
    await page.waitForTimeout(100);
    assert.deepEqual(await shapes(), { shown: true, count: (await scene(page)).links.flatMap((link) => link.collisions).length });
    await panel.locator("summary").click();
    await until(page, "state.distances === null");
    assert.equal((await shapes()).shown, true, "they are shown without distances");
    await page.getByRole("switch", { name: "Collision shapes" }).uncheck();
    assert.equal((await shapes()).shown, false);
    assert.equal(await lines(page), 0);
  }));

test("a model without collision shapes says so", () =>
  visit(["panda"], async (page) => {
    const panel = await openPanel(page, "distances");
    await panel.getByText("No link of this model has a collision shape.").waitFor();
  }));

test("obstacles are added, dragged by the handle, moved by fields and removed", () =>
  visit([CELL], async (page) => {
    const panel = await openPanel(page, "obstacles");
    await panel.getByRole("button", { name: "Add" }).click();
    await until(page, 'scene.obstacles.length === 1 && scene.obstacles[0].name === "sphere 1" && state.obstacles.length === 1');
    await panel.getByRole("button", { name: "sphere 1", exact: true, pressed: true }).waitFor();
    await page.getByRole("button", { name: "front" }).click();
    const place = await drag(page, [0.1, 0, 0]);
    await untilNear(page, "state.obstacles[0].position", place, 1e-6);
    assert.ok((await state(page)).target.position[0] === (await state(page)).tool.position[0], "the target stays");
    await enter(panel.getByLabel("z of sphere 1 in the world frame (m)"), 0.9);
    await until(page, "Math.abs(state.obstacles[0].position[2] - 0.9) < 1e-9");
    await page.keyboard.press("Tab");
    await page.locator("canvas").focus();
    await page.keyboard.press("Escape");
    await panel.getByRole("button", { name: "sphere 1", exact: true, pressed: false }).waitFor();
    await panel.getByLabel("Shape of a new obstacle").selectOption("box");
    await enter(panel.getByLabel("Edge of the new box along z (m)"), 0.3);
    await panel.getByRole("button", { name: "Add" }).click();
    await until(page, 'scene.obstacles.length === 2 && scene.obstacles[1].size[2] === 0.3 && state.obstacles.length === 2');
    await panel.getByRole("button", { name: "Remove sphere 1" }).click();
    await until(page, 'scene.obstacles.length === 1 && scene.obstacles[0].name === "box 1"');
    await enter(panel.getByLabel("Edge of the new box along x (m)"), 0);
    await panel.getByRole("button", { name: "Add" }).click();
    await page.locator(".toast.bad").waitFor();
    assert.match(await page.locator(".toast.bad").innerText(), /size = 0 m is not positive/);
  }));

test("a click on an obstacle puts the handle on it", () =>
  visit([CELL, ...BALL], async (page) => {
    await page.getByRole("button", { name: "side" }).click();
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    const at = await page.evaluate(() => {
      const { project, stage } = /** @type {any} */ (window).viewer;
      const box = stage.renderer.domElement.getBoundingClientRect();
      const [x, y] = project([0.4, 0.25, 0.3]);
      return { x: box.left + ((x + 1) / 2) * box.width, y: box.top + ((1 - y) / 2) * box.height };
    });
    await page.mouse.click(at.x, at.y);
    await page.getByRole("toolbar", { name: "View" }).getByRole("button", { name: "ball", pressed: true }).waitFor();
  }));

for (const [name, dark, width, height] of /** @type {const} */ ([["light", false, 1280, 1000], ["phone", true, 390, 844]])) {
  test(`a servo that avoids collisions stops before an obstacle and names it, ${name}`, () =>
    visit([CELL, ...BALL], async (page) => {
      for (const panel of ["distances", "obstacles"]) await openPanel(page, panel);
      const target = (await state(page)).target.position;
      await moveTarget(page, "y", 0.25 - target[1]);
      await moveTarget(page, "x", 0.4 - target[0]);
      await moveTarget(page, "z", 0.3 - target[2]);
      await until(page, 'state.servo.status === "stalled" && state.servo.reason === "distance"');
      assert.deepEqual((await state(page)).servo.pair, ["flange", "ball"]);
      await page.getByText("flange and ball must not come closer").waitFor();
      assert.match(await page.locator("[data-near].stops").innerText(), /flange\s+ball/);
      const nearest = (await state(page)).distances?.near[0]?.distance ?? 0;
      assert.ok(nearest > 0.01 - 1e-6 && nearest < 0.012, `${nearest}`);
      const cut = await page.evaluate(() => [...document.querySelectorAll(".side *")].filter((element) => element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).overflowX === "visible" && element.clientWidth > 0).map((element) => `${element.tagName}.${element.className}`));
      assert.deepEqual(cut, [], "text runs out of its place");
      await page.getByRole("switch", { name: "Collision shapes" }).check();
      await page.waitForFunction(() => /** @type {any} */ (window).viewer.collisions.group.visible);
      await picture(page, `obstacles-${name}`);
      if (name === "phone") {
        await page.locator('[data-panel="distances"]').scrollIntoViewIfNeeded();
        await picture(page, `obstacles-${name}-distances`);
        await page.locator('[data-panel="obstacles"]').scrollIntoViewIfNeeded();
        await picture(page, `obstacles-${name}-panel`);
        return;
      }
      await page.getByRole("switch", { name: "Avoid collisions" }).uncheck();
      await until(page, 'scene.avoidance === null && state.servo.status === "reached"');
    }, { dark, width, height }));
}

test("an address carries obstacles and avoidance", () =>
  served([CELL, ...BALL], async ({ url }) => {
    let address = "";
    await look(url, async (page) => {
      const panel = await openPanel(page, "obstacles");
      await panel.getByRole("button", { name: "Add" }).click();
      await until(page, "scene.obstacles.length === 2 && state.obstacles.length === 2");
      await enter(panel.getByLabel("x of ball in the world frame (m)"), 0.7);
      await until(page, "Math.abs(state.obstacles[0].position[0] - 0.7) < 1e-9");
      await enter(panel.getByLabel("Least distance (m)"), 0.03);
      await until(page, "scene.avoidance.gap === 0.03");
      await page.getByRole("button", { name: /Copy a link/ }).click();
      await page.waitForFunction(() => location.hash.includes("obstacles="));
      address = page.url();
    });
    await look(address, async (page) => {
      await until(page, "scene.obstacles.length === 2 && state.obstacles.length === 2 && scene.avoidance.gap === 0.03 && Math.abs(state.obstacles[0].position[0] - 0.7) < 1e-9");
      assert.equal((await scene(page)).obstacles[1]?.name, "sphere 1");
    });
  }));
