/** Closed chains: driven joints toggled one by one, the object dragged; numbers agree with the command line. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { apart, cylindroid, drag, launch, open, openPanel, picture, scene, serve, state, until } from "./lib.mjs";

/** @type {import("playwright-core").Browser} */
let browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

test("toggling drives of the five-bar shows the numbers of manipulability", async () => {
  const server = await serve("five-bar");
  try {
    const { page, troubles, close } = await open(browser, server.url, { width: 1280, height: 720 });
    await openPanel(page, "capability");
    for (const [toggle, driven] of /** @type {[string, string][]} */ ([["", "q1,q2"], ["q5", "q1,q2,q5"], ["q2", "q1,q5"]])) {
      if (toggle) await page.locator(`[data-drive="${toggle}"]`).click();
      const wanted = await cylindroid("manipulability", "five-bar", "--actuated", driven);
      for (const kind of ["kinematic", "active_force", "passive_force"]) {
        const values = JSON.stringify(wanted[kind].finite);
        await page.waitForFunction(([name, text]) => {
          const shown = document.querySelector(`[data-efficiency="${name}"]`)?.getAttribute("data-values");
          if (!shown) return false;
          const [a, b] = [JSON.parse(shown), JSON.parse(text ?? "")];
          return a.length === b.length && a.every((/** @type {number} */ value, /** @type {number} */ i) => Math.abs(value - b[i]) <= 1e-9 * Math.abs(b[i]));
        }, [kind, values]);
      }
    }
    const drives = (await scene(page)).drives.filter((drive) => drive.actuated).map((drive) => drive.name);
    assert.deepEqual(drives.sort(), ["q1", "q5"]);
    await picture(page, "five-bar-manipulability");
    assert.deepEqual(troubles, []);
    await close();
  } finally {
    await server.stop();
  }
});

test("with one drive of the five-bar the object is free, and the page says so", async () => {
  const server = await serve("five-bar");
  try {
    const { page, close } = await open(browser, server.url);
    await page.locator('[data-drive="q2"]').click();
    await until(page, 'state.servo.status === "unavailable"');
    const shown = await page.locator('[data-panel="pose"]').innerText();
    assert.ok(shown.includes((await state(page)).servo.sentence));
    await close();
  } finally {
    await server.stop();
  }
});

test("the coupler of the five-bar is dragged, and the loop stays closed", async () => {
  const server = await serve("five-bar");
  try {
    const { page, troubles, close } = await open(browser, server.url);
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.task.components.join() === "x,y");
    const before = (await state(page)).target.position;
    await drag(page, [0, -0.4, 0]);
    await until(page, `state.target.position[1] < ${before[1] - 0.2} && state.servo.status === "reached"`);
    const now = await state(page);
    assert.ok(now.error.position < 2e-3 && now.gap?.closed);
    assert.ok(Math.abs(now.target.position[0] - before[0]) < 1e-6);
    assert.deepEqual(troubles, []);
    await close();
  } finally {
    await server.stop();
  }
});

test("the platform of the stewart follows its target with closed loops", async () => {
  const server = await serve("stewart");
  try {
    const { page, troubles, close } = await open(browser, server.url);
    const { position } = (await state(page)).target;
    const field = page.locator('[data-target="z"]');
    await field.fill(String((position[2] ?? 0) + 0.08));
    await field.press("Enter");
    await until(page, `state.servo.status === "reached" && Math.abs(state.tool.position[2] - ${(position[2] ?? 0) + 0.08}) < 2e-3`);
    const now = await state(page);
    assert.ok(now.gap?.closed);
    for (const { a, b } of now.loops) assert.ok(apart(a, b) < 1e-6);
    assert.deepEqual(troubles, []);
    await close();
  } finally {
    await server.stop();
  }
});
