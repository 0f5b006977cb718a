/** Planar mechanisms open flat and stay flat; every model is looked at along the axes. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, browserOfFile, picture } from "./lib.mjs";

const { visit } = browserOfFile();

/**
 * From where one looks, in units of the distance.
 * @param {import("playwright-core").Page} page
 */
const way = (page) => page.evaluate(() => {
  const { camera: { position }, orbit: { target } } = /** @type {any} */ (window).viewer.stage;
  return { way: position.clone().sub(target).normalize().toArray(), target: target.toArray() };
});

/**
 * Drags beside the mechanism.
 * @param {import("playwright-core").Page} page
 * @param {"left" | "right"} button
 */
async function dragView(page, button) {
  const canvas = await page.locator("canvas").boundingBox();
  const [x, y] = [(canvas?.x ?? 0) + 20, (canvas?.y ?? 0) + (canvas?.height ?? 0) - 60];
  await page.mouse.move(x, y);
  await page.mouse.down({ button });
  await page.mouse.move(x + 40, y - 30, { steps: 4 });
  await page.mouse.up({ button });
}

for (const [width, height, dark] of /** @type {const} */ ([[1366, 768, false], [390, 844, true]])) {
  test(`a planar mechanism is seen along z, a drag pans it and the right button tilts it, ${width} x ${height}`, () =>
    visit(["five-bar"], async (page) => {
      const canvas = page.locator("canvas");
      await page.getByRole("button", { name: "orthographic", pressed: true }).waitFor();
      assert.ok(apart((await way(page)).way, [0, 0, 1]) < 1e-3);
      assert.match((await canvas.getAttribute("aria-label")) ?? "", /Drag to pan/);
      await picture(page, `planar-${width}-${dark ? "dark" : "light"}`);
      const first = await way(page);
      await dragView(page, "left");
      const panned = await way(page);
      assert.ok(apart(panned.way, first.way) < 1e-6, "flat as before");
      assert.ok(apart(panned.target, first.target) > 1e-3, "but elsewhere");
      await dragView(page, "right");
      const tilted = await way(page);
      assert.ok(apart(tilted.way, [0, 0, 1]) > 0.01);
      // Seen from aside a drag turns as for other models.
      assert.match((await canvas.getAttribute("aria-label")) ?? "", /Drag to rotate/);
      await dragView(page, "left");
      assert.ok(apart((await way(page)).way, tilted.way) > 0.01);
      await page.getByRole("button", { name: "top", exact: true }).click();
      assert.ok(apart((await way(page)).way, [0, 0, 1]) < 1e-3);
      assert.match((await canvas.getAttribute("aria-label")) ?? "", /Drag to pan/);
      // With perspective it is a body in space.
      await page.getByRole("button", { name: "orthographic" }).click();
      assert.match((await canvas.getAttribute("aria-label")) ?? "", /Drag to rotate/);
    }, { width, height, dark }));
}

test("every model is looked at along the axes, by buttons and by keys", () =>
  visit(["panda"], async (page) => {
    /** @type {[string, string, number[]][]} */
    const views = [["2", "front", [0, -1, 0]], ["3", "side", [1, 0, 0]], ["4", "top", [0, 0, 1]]];
    await page.locator("canvas").focus();
    for (const [key, name, wanted] of views) {
      await page.keyboard.press("1");
      assert.ok(apart((await way(page)).way, wanted) > 0.1);
      await page.keyboard.press(key);
      assert.ok(apart((await way(page)).way, wanted) < 1e-3, name);
      await page.keyboard.press("1");
      await page.getByRole("button", { name, exact: true }).click();
      assert.ok(apart((await way(page)).way, wanted) < 1e-3, name);
      await picture(page, `view-${name}`);
    }
    // Drags turn it from anywhere, also where it is seen from above.
    await page.getByRole("button", { name: "orthographic" }).click();
    await dragView(page, "left");
    assert.ok(apart((await way(page)).way, [0, 0, 1]) > 0.01);
  }));
