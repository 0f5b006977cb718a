/** Closed chains: actuated joints toggled one by one, the object dragged; numbers agree with the command line. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, browserOfFile, cylindroid, drag, moveTarget, openPanel, picture, scene, showOverlay, state, until, untilReached } from "./lib.mjs";

const { visit } = browserOfFile();

test("toggling actuated joints of the five-bar shows the numbers of manipulability", () =>
  visit(["five-bar"], async (page) => {
    await openPanel(page, "capability");
    let squeezes = 0;
    for (const [toggle, actuated] of /** @type {[string, string][]} */ ([["", "q1,q2"], ["q5", "q1,q2,q5"], ["q2", "q1,q5"]])) {
      if (toggle) await page.locator(`[data-actuator="${toggle}"]`).click();
      const wanted = await cylindroid("manipulability", "five-bar", "--actuated", actuated);
      for (const kind of ["kinematic", "active_force", "passive_force", "internal_force"]) {
        if (kind === "internal_force" && wanted[kind].finite.length === 0) continue;
        squeezes += Number(kind === "internal_force");
        const values = JSON.stringify(wanted[kind].finite);
        await page.waitForFunction(([name, text]) => {
          const shown = document.querySelector(`[data-efficiency="${name}"]`)?.getAttribute("data-values");
          if (!shown) return false;
          const [a, b] = [JSON.parse(shown), JSON.parse(text ?? "")];
          return a.length === b.length && a.every((/** @type {number} */ value, /** @type {number} */ i) => Math.abs(value - b[i]) <= 1e-9 * Math.abs(b[i]));
        }, [kind, values]);
      }
    }
    const actuated = (await scene(page)).actuators.filter((actuator) => actuator.actuated).map((actuator) => actuator.name);
    assert.deepEqual(actuated.sort(), ["q1", "q5"]);
    assert.equal(squeezes, 1, "only with three actuated joints");
    assert.equal(await page.locator('[data-efficiency="internal_force"]').count(), 0);
    await picture(page, "five-bar-manipulability");
  }, { width: 1280, height: 720 }));

for (const [model, overlay, words] of /** @type {[string, string, RegExp][]} */ ([
  ["five-bar", "velocity-ellipsoid", /2\.29 · 0\.874\sm\/s/],
  ["five-bar", "active-force-ellipsoid", /1\.14 · 0\.437\sN, 1\sN is \S+\sm/],
  // All three fit at one scale.
  ["stewart", "angular-velocity-ellipsoid", /1\.27 · 1\.19 · 1\.19\srad\/s/],
])) {
  test(`semi-axes of the ${overlay} of the ${model} have one scale`, () =>
    visit([model], async (page) => {
      await showOverlay(page, overlay);
      assert.match(await page.locator(".legend").innerText(), words);
    }));
}

for (const model of ["five-bar", "panda", "stewart", "3r"]) {
  test(`ellipsoids of the ${model} are drawn in the proportions of their numbers, at the scale of the legend`, () =>
    visit([model], async (page) => {
      for (const overlay of ["velocity-ellipsoid", "active-force-ellipsoid"]) {
        await showOverlay(page, overlay);
        const sizes = await page.evaluate((name) => /** @type {any} */ (window).viewer.session.state.overlays[name].axes.map((/** @type {{ size: number }} */ axis) => axis.size), overlay);
        assert.ok(sizes.length > 1);
        const drawn = await page.waitForFunction(() => {
          /** @type {number[][]} */
          const found = [];
          /** @type {any} */ (window).viewer.stage.scene.traverse((/** @type {any} */ part) => {
            if (part.isMesh && part.renderOrder === 2 && part.geometry.type === "SphereGeometry" && !part.matrixAutoUpdate) {
              const e = part.matrix.elements;
              found.push([0, 4, 8].map((i) => Math.hypot(e[i], e[i + 1], e[i + 2])));
            }
          });
          return found.length === 1 && found[0];
        });
        const lengths = /** @type {number[]} */ (await drawn.jsonValue());
        const scale = (lengths[0] ?? 0) / sizes[0];
        for (const [i, size] of sizes.entries()) assert.ok(Math.abs((lengths[i] ?? 0) - scale * size) < 1e-9 * size * scale, `${overlay}: ${lengths} of ${sizes}`);
        const said = /is (\S+)\sm/.exec(await page.locator(".legend").innerText())?.[1];
        assert.ok(Math.abs(Number(said) / scale - 1) < 0.05, `${overlay}: ${said} of ${scale}`);
        await page.locator(`[data-overlay="${overlay}"]`).uncheck();
        await page.waitForFunction(() => !document.querySelector(".legend")?.textContent?.includes("is "));
      }
    }));
}

test("with one actuated joint of the five-bar the object is free, and the page says so", () =>
  visit(["five-bar"], async (page) => {
    await page.locator('[data-actuator="q2"]').click();
    await until(page, 'state.servo.status === "unavailable"');
    const shown = await page.locator('[data-panel="pose"]').innerText();
    assert.ok(shown.includes((await state(page)).servo.sentence));
  }));

test("the coupler of the five-bar is dragged, and the loop stays closed", () =>
  visit(["five-bar"], async (page) => {
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await until(page, 'scene.task.components.join() === "x,y"');
    const before = (await state(page)).target.position;
    const place = await drag(page, [0, -0.4, 0]);
    await untilReached(page, place);
    const now = await state(page);
    assert.ok(now.target.position[1] < before[1] - 0.2);
    assert.ok((now.error.position ?? 1) < 2e-3 && now.closure_error?.closed);
    assert.ok(Math.abs(now.target.position[0] - before[0]) < 1e-6);
  }));

test("the platform of the stewart follows its target with closed loops", () =>
  visit(["stewart"], async (page) => {
    const target = await moveTarget(page, "z", 0.08);
    await untilReached(page, target);
    const now = await state(page);
    assert.ok(apart(now.tool.position.slice(2), target.slice(2)) < 2e-3);
    assert.ok(now.closure_error?.closed);
    for (const { a, b } of now.loops) assert.ok(apart(a, b) < 1e-6);
  }));
