/** Several models in one view: each with a session of its own, where one puts it, solid or transparent. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, browserOfFile, enter, openPanel, picture, state } from "./lib.mjs";

const { visit } = browserOfFile();

/**
 * @param {import("playwright-core").Page} page
 * @returns {Promise<{ name: string, q: number[], place: number[], size: number[] }[]>}
 */
const beside = (page) => page.evaluate(() => [.../** @type {any} */ (window).viewer.companions.all.values()].map(({ session, group, robot }) => {
  const box = robot.box();
  return { name: session.scene?.name, q: session.state?.q, place: group.position.toArray(), size: [box.min.x, box.max.x] };
}));

/**
 * Waits until these models stand beside the first.
 * @param {import("playwright-core").Page} page
 * @param {string[]} names
 */
async function until(page, names) {
  await page.waitForFunction((wanted) => {
    const all = [.../** @type {any} */ (window).viewer.companions.all.values()];
    return JSON.stringify(all.map(({ session, isPlaced }) => isPlaced && session.scene.name)) === wanted;
  }, JSON.stringify(names));
}

/**
 * @param {import("playwright-core").Page} page
 * @param {string} name
 */
async function add(page, name) {
  await page.getByRole("button", { name: "Open a file" }).click();
  await page.getByRole("button", { name: `${name} beside the model that is shown` }).first().click();
  await page.locator("dialog").waitFor({ state: "hidden" });
}

for (const [width, height, dark] of /** @type {const} */ ([[1366, 768, false], [390, 844, true]])) {
  test(`models of the catalogue stand beside the first and have joints of their own, ${width} x ${height}`, () =>
    visit(["3r"], async (page, server) => {
      await add(page, "ur5e");
      await until(page, ["ur5e"]);
      const first = await state(page);
      const [other] = await beside(page);
      const own = await page.evaluate(() => /** @type {any} */ (window).viewer.robot.box().max.x);
      assert.ok(other && (other.size[0] ?? 0) > own, "to the right of the first");
      const panel = page.locator('[data-panel="beside"]');
      await panel.locator('[data-panel="beside-1"] > summary').click();
      const [joint] = await page.evaluate(() => [.../** @type {any} */ (window).viewer.companions.all.values()][0].session.scene.coordinates.map((/** @type {any} */ one) => one.name));
      await enter(panel.getByLabel(`${joint} as a number`), 0.75);
      await page.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.all.values()][0].session.state.q[0] === 0.75);
      assert.deepEqual((await state(page)).q, first.q, "the first is not moved");
      // A second one, put where one likes.
      await add(page, "3r");
      await until(page, ["ur5e", "3r"]);
      const fields = panel.getByRole("group", { name: "Model beside, 2" });
      for (const [part, value] of /** @type {const} */ ([["x", 0], ["y", -0.5], ["z", 0.25]])) await enter(fields.locator(`[data-beside="${part}"]`), value);
      assert.ok(apart((await beside(page))[1]?.place ?? [], [0, -0.5, 0.25]) < 1e-9);
      await fields.getByLabel("Transparent").check();
      await page.getByRole("button", { name: "Show all" }).click();
      await picture(page, `beside-${width}-${dark ? "dark" : "light"}`);
      const opacities = await page.evaluate(() => {
        /** @type {Set<boolean>} */
        const found = new Set();
        [.../** @type {any} */ (window).viewer.companions.all.values()][1].robot.group.traverse((/** @type {any} */ part) => part.isMesh && found.add(part.material.opacity < 1));
        return [...found];
      });
      assert.deepEqual(opacities, [true]);
      // The address brings them back.
      assert.match(page.url(), /\?beside=1&beside=command$/);
      await page.reload();
      await until(page, ["ur5e", "3r"]);
      await panel.getByRole("button", { name: "Remove the model beside, 1" }).click();
      await until(page, ["3r"]);
      assert.equal(new URL(page.url()).search, "?beside=command");
      await panel.getByRole("button", { name: "Remove the model beside, 2" }).press("Enter");
      await panel.waitFor({ state: "hidden" });
      assert.equal(page.url(), server.url);
    }, { width, height, dark }));
}

test("the model of the command stands beside itself, and one that is gone is told", () =>
  visit(["five-bar"], async (page, server) => {
    await page.getByRole("button", { name: "Open a file" }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "five-bar beside the model that is shown" }).first().press("Enter");
    await until(page, ["five-bar"]);
    await openPanel(page, "beside-1");
    const panel = page.locator('[data-panel="beside"]');
    // A closed chain has its switches of actuated joints.
    await panel.locator('[data-actuator="q2"]').uncheck();
    await page.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.all.values()][0].session.scene.actuators.some((/** @type {any} */ one) => one.name === "q2" && !one.actuated));
    await page.goto(`${server.url}?beside=77`);
    await page.getByText(/model 77 is not open on this server/).first().waitFor();
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.companions.all.size === 0);
    assert.equal(page.url(), server.url);
  }));
