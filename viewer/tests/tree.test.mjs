/** The tree of links, joints and frames; picking in the view; what is selected is marked and can become the tool. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { apart, browserOfFile, enter, moveTarget, openPanel, picture, scene, state, until, untilReached } from "./lib.mjs";

const { visit } = browserOfFile();
const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));
const SHAPES = fileURLToPath(new URL("robots/shapes/shapes.urdf", import.meta.url));

/**
 * What is marked: the name of the item, the number of its bodies, and the place of its frame.
 * @param {import("playwright-core").Page} page
 * @returns {Promise<{ name: string | null, bodies: number, frame: number[] }>}
 */
const marked = (page) => page.evaluate(() => {
  const { mark, selection } = /** @type {any} */ (window).viewer;
  mark.group.updateMatrixWorld(true);
  return { name: selection.marked?.name ?? null, bodies: mark.bodies.children.length, frame: mark.frame.matrixWorld.elements.slice(12, 15) };
});

/**
 * A click at a place of the world.
 * @param {import("playwright-core").Page} page
 * @param {number[]} place
 */
async function clickAt(page, place) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const { x, y } = await page.evaluate((at) => {
    const { stage, project } = /** @type {any} */ (window).viewer;
    const box = stage.renderer.domElement.getBoundingClientRect();
    const [right, up] = project(at);
    return { x: box.left + ((right + 1) / 2) * box.width, y: box.top + ((1 - up) / 2) * box.height };
  }, place);
  await page.mouse.click(x, y);
}

/**
 * @param {import("playwright-core").Page} page
 * @param {string} key
 */
const row = (page, key) => page.locator(`[data-item="${key}"]`);

test("the tree has every link, joint and frame, each below what it is fixed to", () =>
  visit(["panda"], async (page) => {
    const panel = await openPanel(page, "model");
    const { links, joints, frames } = await scene(page);
    const linked = new Set(links.map(({ name }) => name));
    const extra = frames.filter(({ name }) => !linked.has(name));
    assert.equal(await panel.getByRole("treeitem").count(), links.length + joints.length + extra.length);
    const levels = await panel.getByRole("treeitem").evaluateAll((all) => all.map((one) => [one.getAttribute("data-item"), Number(one.getAttribute("aria-level"))]));
    const level = Object.fromEntries(levels);
    for (const { name, parent, child } of joints) {
      assert.equal(level[`joint ${name}`], level[`link ${links[parent]?.name}`] + 1);
      assert.equal(level[`link ${links[child]?.name}`], level[`joint ${name}`] + 1);
    }
    await picture(page, "tree-panda");
  }, { width: 1366, height: 768 }));

test("an item under the pointer is marked with its frame, and one that is selected stays marked", () =>
  visit(["panda"], async (page) => {
    await openPanel(page, "model");
    await row(page, "link link4").hover();
    const { links } = await scene(page);
    const index = links.findIndex(({ name }) => name === "link4");
    const at = async () => (await state(page)).links[index]?.position ?? [];
    const over = await marked(page);
    assert.ok(over.name === "link4" && over.bodies > 0 && apart(over.frame, await at()) < 1e-6, JSON.stringify(over));
    await page.mouse.move(700, 300);
    assert.equal((await marked(page)).name, null);
    await row(page, "link link4").click();
    await page.mouse.move(700, 300);
    assert.equal((await marked(page)).name, "link4");
    await page.getByRole("group", { name: "Selected" }).getByText("link4", { exact: true }).waitFor();
    await picture(page, "tree-selected");
    // It moves with the robot.
    await enter(page.getByLabel("panda_joint2 as a number"), 0.4);
    await until(page, "Math.abs(state.q[1] - 0.4) < 1e-9");
    assert.ok(apart((await marked(page)).frame, await at()) < 1e-6);
    const shown = await page.locator('[data-panel="model"] dd').allTextContents();
    assert.ok(apart(shown.slice(0, 3).map((words) => Number(words.replace("−", "-"))), await at()) < 1e-5, `${shown}`);
    // The axis of a joint lies in its frame, which the server gives in the parent link.
    await row(page, "joint panda_joint4").click();
    assert.equal((await marked(page)).name, "panda_joint4");
    await page.mouse.move(700, 300);
    await page.keyboard.press("Escape");
    assert.equal((await marked(page)).name, null);
    await page.getByRole("group", { name: "Selected" }).waitFor({ state: "hidden" });
  }, { width: 1366, height: 768 }));

test("the tree is moved through, folded and searched by the keyboard, and makes a frame the tool", () =>
  visit(["panda"], async (page) => {
    await page.locator('[data-panel="model"] > summary').focus();
    await page.keyboard.press("Enter");
    await page.keyboard.press("Tab");
    const search = page.getByLabel("Search links, joints and frames");
    assert.ok(await search.evaluate((field) => field === document.activeElement));
    await page.keyboard.press("Tab");
    const active = () => page.evaluate(() => document.getElementById(document.querySelector('[role="tree"]')?.getAttribute("aria-activedescendant") ?? "")?.getAttribute("data-item"));
    const first = await active();
    assert.ok(first?.startsWith("link "), String(first));
    await page.keyboard.press("ArrowDown");
    const second = await active();
    assert.equal((await marked(page)).name, second?.split(" ")[1]);
    await page.keyboard.press("Home");
    await page.keyboard.press("ArrowLeft");
    assert.equal(await page.getByRole("treeitem").count(), 1, "folded");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    assert.equal(await active(), second);
    await page.keyboard.press("End");
    await page.keyboard.press("Enter");
    const last = await active();
    assert.equal(await page.locator('[role="treeitem"][aria-selected="true"]').getAttribute("data-item"), last);

    await search.fill("LINK7");
    await page.locator('[data-panel="model"]').getByText(/^1 of/).waitFor();
    await search.press("Enter");
    assert.equal((await marked(page)).name, "link7");
    assert.equal(await search.inputValue(), "");
    await page.locator('[data-panel="model"]').getByRole("button", { name: "Use as tool" }).press("Enter");
    await until(page, 'scene.frame === "link7"');
    await row(page, "link link7").getByText("tool", { exact: true }).waitFor();
    await page.getByRole("group", { name: "Selected" }).getByText("tool", { exact: true }).waitFor();
    await untilReached(page, await moveTarget(page, "z", -0.03));
  }, { width: 1366, height: 768 }));

test("a click on a link, a joint or an obstacle picks it, a drag and a click beside them pick nothing", () =>
  visit(["five-bar"], async (page) => {
    const { joints, links } = await scene(page);
    const all = await state(page);
    // The crank, which is away from the handle.
    const carrier = joints.find(({ name }) => name === "q1")?.child ?? 0;
    // Half-way along a rod from one joint to the next.
    const anchors = links[carrier]?.anchors ?? [];
    assert.ok(anchors.length >= 2);
    const place = await page.evaluate(({ index, ends }) => {
      const { robot } = /** @type {any} */ (window).viewer;
      const frame = robot.linkFrame(index);
      const [a, b] = ends.map((end) => frame.localToWorld(frame.position.clone().set(...end)));
      return a.lerp(b, 0.5).toArray();
    }, { index: carrier, ends: [anchors[0]?.position ?? [], anchors[1]?.position ?? []] });
    await clickAt(page, place);
    await page.waitForFunction((name) => /** @type {any} */ (window).viewer.selection.selected?.name === name, links[carrier]?.name);
    const panel = page.locator('[data-panel="model"]');
    assert.equal(await panel.getAttribute("open"), null, "the panel stays folded");
    await page.getByRole("group", { name: "Selected" }).getByText(`${links[carrier]?.name}`, { exact: true }).waitFor();
    await openPanel(page, "model");
    await page.locator('[role="treeitem"][aria-selected="true"]').waitFor();
    assert.equal(await page.locator('[role="treeitem"][aria-selected="true"]').getAttribute("data-item"), `link ${links[carrier]?.name}`);
    // The mark of a joint is above the rods.
    const loop = all.loops[0]?.a ?? [];
    await clickAt(page, loop);
    await page.waitForFunction(() => ["loop", "joint"].includes(/** @type {any} */ (window).viewer.selection.selected?.kind));
    const kept = (await marked(page)).name;
    assert.ok(kept);
    // Dragged: the selection stays. Beside everything: it ends.
    await page.mouse.move(600, 200);
    await page.mouse.down();
    await page.mouse.move(640, 240, { steps: 3 });
    await page.mouse.up();
    assert.equal((await marked(page)).name, kept);
    const canvas = await page.locator("canvas").boundingBox();
    await page.mouse.click((canvas?.x ?? 0) + 8, (canvas?.y ?? 0) + (canvas?.height ?? 0) - 8);
    assert.equal((await marked(page)).name, null);
  }, { width: 1366, height: 768, dark: true }));

test("meshes and simple shapes are picked, and what is hidden is not", () =>
  visit([SHAPES], async (page) => {
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links.some((/** @type {any} */ link) => link.shapes.children.length > 0));
    const { links } = await scene(page);
    const index = links.findIndex(({ visuals }) => visuals.length > 0);
    const place = await page.evaluate((i) => {
      const body = /** @type {any} */ (window).viewer.robot.links[i].shapes.children[0];
      return body.getWorldPosition(body.position.clone()).toArray();
    }, index);
    await clickAt(page, place);
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.selection.selected?.kind === "link");
    const bodies = (await marked(page)).bodies;
    assert.ok(bodies > 0);
    await page.keyboard.press("Escape");
    // Rods in place of shapes: a mark follows what is drawn.
    const name = links[index]?.name ?? "";
    await openPanel(page, "model");
    await row(page, `link ${name}`).click();
    const before = await page.evaluate(() => /** @type {any} */ (window).viewer.mark.copies.map((/** @type {any} */ { of }) => of.uuid));
    await page.locator('[data-overlay="shapes"]').uncheck();
    const after = await page.evaluate(() => /** @type {any} */ (window).viewer.mark.copies.map((/** @type {any} */ { of }) => of.uuid));
    assert.ok(before.every((/** @type {string} */ one) => !after.includes(one)));
  }, { width: 1366, height: 768 }));

test("an observer selects, and chooses no tool", () =>
  visit(["panda"], async (page, server) => {
    const other = await page.context().newPage();
    await other.goto(`${server.url}?session=demo`);
    await other.waitForFunction(() => /** @type {any} */ (window).viewer?.session.state);
    await page.goto(`${server.url}?session=demo`);
    await page.waitForFunction(() => /** @type {any} */ (window).viewer?.session.about?.driver === "another" && /** @type {any} */ (window).viewer.session.state);
    await openPanel(page, "model");
    await row(page, "link link5").click();
    assert.equal((await marked(page)).name, "link5");
    const button = page.getByRole("group", { name: "Selected" }).getByRole("button", { name: "Use as tool" });
    assert.ok(await button.isDisabled());
    await page.getByRole("button", { name: "Take over" }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.about?.driver === "you");
    await button.click();
    await until(page, 'scene.frame === "link5"');
  }, { width: 1366, height: 768 }));

for (const dark of [false, true]) {
  test(`on a phone the card and the tree are in the window, ${dark ? "dark" : "light"}`, () =>
    visit([CELL], async (page) => {
      await openPanel(page, "model");
      const search = page.getByLabel("Search links, joints and frames");
      await search.fill("link4");
      await search.press("Enter");
      const card = page.getByRole("group", { name: "Selected" });
      await card.waitFor();
      const inside = await card.evaluate((element) => {
        const box = element.getBoundingClientRect();
        const canvas = document.querySelector("canvas")?.getBoundingClientRect();
        return box.left >= 0 && box.right <= innerWidth && box.bottom <= (canvas?.bottom ?? 0) && document.documentElement.scrollWidth <= innerWidth;
      });
      assert.ok(inside);
      await page.locator('[data-panel="model"]').scrollIntoViewIfNeeded();
      await picture(page, `tree-phone-${dark ? "dark" : "light"}`);
    }, { width: 390, height: 844, dark }));
}
