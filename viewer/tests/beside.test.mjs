/** Several models in one view: each with a session of its own, where one puts it, solid or transparent. */
import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { addBeside, apart, beside, browserOfFile, enter, openFiles, openPanel, picture, saved, served, state, untilBeside, untilBesideAt } from "./lib.mjs";

const { look, visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-beside-"));

for (const [width, height, dark] of /** @type {const} */ ([[1366, 768, false], [390, 844, true]])) {
  test(`models of the catalogue stand beside the first and have joints of their own, ${width} x ${height}`, () =>
    visit(["3r"], async (page, server) => {
      await addBeside(page, "ur5e");
      await untilBeside(page, ["ur5e"]);
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
      await addBeside(page, "3r");
      await untilBeside(page, ["ur5e", "3r"]);
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
      assert.match(page.url(), /\?beside=[0-9a-f]{16}&beside=command$/);
      await page.reload();
      await untilBeside(page, ["ur5e", "3r"]);
      await panel.getByRole("button", { name: "Remove the model beside, 1" }).click();
      await untilBeside(page, ["3r"]);
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
    await untilBeside(page, ["five-bar"]);
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

test("an observer sees the models beside the first, and moves them once it drives", () =>
  served(["3r"], ({ url }) =>
    look(`${url}?session=demo`, async (driver) => {
      await driver.locator(".role").getByText("Driving, 1 page").waitFor();
      await addBeside(driver, "ur5e");
      await untilBeside(driver, ["ur5e"]);
      await look(`${url}?session=demo`, async (observer) => {
        await untilBeside(observer, ["ur5e"]);
        assert.deepEqual((await beside(observer))[0]?.place, (await beside(driver))[0]?.place);
        await openPanel(driver, "beside-1");
        const field = (/** @type {import("playwright-core").Page} */ page) => page.locator('[data-panel="beside-1"] .field').first();
        await enter(field(driver), 0.75);
        await untilBesideAt(observer, 0, 0.75);
        assert.ok(await observer.locator('[data-panel="beside"] > .body').evaluate((body) => /** @type {HTMLElement} */ (body).inert));
        await observer.evaluate(() => /** @type {any} */ (window).viewer.companions.add(null));
        await observer.getByText("Only the page that drives").waitFor();
        assert.equal((await beside(observer)).length, 1);
        await picture(observer, "beside-observer");

        await observer.locator('[data-role="drive"]').click();
        await observer.locator(".role").getByText("Driving, 2 pages").waitFor();
        await observer.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.all.values()][0].session.drives);
        await openPanel(observer, "beside-1");
        await enter(field(observer), -0.25);
        await untilBesideAt(driver, 0, -0.25);
        await enter(observer.locator('[data-beside="y"]'), 0.5);
        await driver.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.all.values()][0].group.position.y === 0.5);
        // Who comes back finds them.
        await driver.reload();
        await untilBeside(driver, ["ur5e"]);
        await untilBesideAt(driver, 0, -0.25);
        await observer.getByRole("button", { name: "Remove the model beside, 1" }).click();
        await untilBeside(driver, []);
        assert.equal(driver.url(), `${url}?session=demo`);
      });
    })));

/**
 * Whether the links of the model beside the first are drawn at these poses.
 * @param {import("playwright-core").Page} page
 * @param {"film" | "viewer" | "gone"} by who draws it
 * @param {{ quaternion: number[] }[]} links
 */
async function untilDrawnAt(page, by, links) {
  await page.waitForFunction(([from, wanted]) => {
    const { viewer, film } = /** @type {any} */ (window);
    const { all } = from === "film" ? film.beside : from === "gone" ? viewer.companions.gone : viewer.companions;
    const [model] = all.values();
    const drawn = !model?.group.visible ? [] : model.robot.links.flatMap((/** @type {any} */ { frame: { quaternion: { w, x, y, z } } }) => [w, x, y, z]);
    return drawn.length === wanted.length && drawn.every((/** @type {number} */ value, /** @type {number} */ i) => Math.abs(value - (wanted[i] ?? NaN)) < 1e-9);
  }, /** @type {[string, number[]]} */ ([by, links.flatMap(({ quaternion }) => quaternion)]));
}

test("models beside the first are recorded and played with it, here and on a page by itself", () =>
  visit(["3r"], async (page) => {
    await addBeside(page, "ur5e");
    await untilBeside(page, ["ur5e"]);
    await openPanel(page, "beside-1");
    await page.getByRole("button", { name: "Record" }).click();
    const field = page.locator('[data-panel="beside-1"] .field').first();
    for (const value of [0.75, -0.5]) {
      await enter(field, value);
      await untilBesideAt(page, 0, value);
      await page.waitForTimeout(500);
    }
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const { states, beside: [track] } = JSON.parse(await saved(page, "Save the recording as JSON"));
    assert.equal(track.model, "ur5e");
    assert.equal(track.times.length, track.states.length);
    const values = track.states.map((/** @type {any} */ one) => one.q[0]);
    const at = values.indexOf(0.75);
    assert.ok(at > 0 && values.at(-1) === -0.5 && track.times[at] < track.times.at(-1) - 0.3, `${values} at ${track.times}`);
    // The first has not moved: nothing of it was sent.
    assert.equal(new Set(states.map((/** @type {any} */ one) => String(one.q))).size, 1);
    await page.evaluate((time) => /** @type {any} */ (window).viewer.timeline.player.seek(time), track.times[at]);
    await untilDrawnAt(page, "viewer", track.states[at].links);
    assert.equal((await beside(page))[0]?.q[0], -0.5, "it has not moved");
    await picture(page, "beside-recorded");
    // Plots of the first last as long as the recording.
    const lasts = await page.evaluate(() => [.../** @type {any} */ (window).viewer.timeline.plots.charts.values()].map(({ plot }) => plot?.scales.x.max).filter(Boolean));
    assert.ok(lasts.length > 0 && lasts.every((/** @type {number} */ last) => last === track.times.at(-1)), `${lasts} of ${track.times.at(-1)}`);
    const path = join(folder, "beside.html");
    await writeFile(path, await saved(page, "Save HTML that plays the recording by itself"));
    await page.getByRole("button", { name: "live" }).click();
    await untilDrawnAt(page, "viewer", track.states.at(-1).links);
    // One that is removed remains in the recording.
    await page.evaluate((time) => /** @type {any} */ (window).viewer.timeline.player.seek(time), track.times[at]);
    await untilDrawnAt(page, "viewer", track.states[at].links);
    await page.getByRole("button", { name: "Remove the model beside, 1" }).click();
    await untilBeside(page, []);
    await untilDrawnAt(page, "gone", track.states[at].links);
    await page.getByRole("button", { name: "live" }).click();
    await page.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.gone.all.values()].every(({ group }) => !group.visible));
    const film = await page.context().newPage();
    await film.goto(pathToFileURL(path).href);
    await film.waitForFunction(() => /** @type {any} */ (window).film?.stage.frames > 1);
    await untilDrawnAt(film, "film", track.states[0].links);
    const names = await film.evaluate(() => {
      const { recording } = /** @type {any} */ (window).film;
      return [...recording.beside.keys(), ...recording.sceneAt(0).beside.flatMap((/** @type {any} */ one) => [one.model, one.session])];
    });
    assert.deepEqual(names, ["1", null, "1"], "none of the server");
    await film.evaluate((time) => /** @type {any} */ (window).film.player.seek(time), track.times[at]);
    await untilDrawnAt(film, "film", track.states[at].links);
    await picture(film, "beside-film");
  }));

test("CSV and plots have all models, each by its name, as it was sent last", () =>
  visit(["3r"], async (page) => {
    await addBeside(page, "3r");
    await untilBeside(page, ["3r"]);
    await page.getByRole("button", { name: "Record" }).click();
    const field = (/** @type {number} */ i) => page.locator(`[data-panel="beside-${i}"] .field`).first();
    await openPanel(page, "beside-1");
    await enter(field(1), 0.75);
    await untilBesideAt(page, 0, 0.75);
    // One that comes later has no values before, one that goes none after.
    await addBeside(page, "ur5e");
    await untilBeside(page, ["3r", "ur5e"]);
    await openPanel(page, "beside-2");
    await enter(field(2), -0.5);
    await untilBesideAt(page, 1, -0.5);
    await page.getByRole("button", { name: "Remove the model beside, 1" }).click();
    await untilBeside(page, ["ur5e"]);
    await enter(field(2), 0.25);
    await untilBesideAt(page, 0, 0.25);
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const all = JSON.parse(await saved(page, "Save the recording as JSON"));
    const text = await saved(page, "Save the recording as CSV");
    const [head = [], ...rows] = text.trim().split("\r\n").map((line) => line.split(","));
    const joints = (/** @type {any} */ one, prefix = "") => one.joint_names.map((/** @type {string} */ name) => prefix + name);
    const [copy, other] = all.beside;
    const names = [["", all], ["3r 2.", copy], ["ur5e.", other]];
    assert.equal(head[0], "time");
    assert.equal(new Set(head).size, head.length);
    assert.ok(rows.every((row) => row.length === head.length));
    const times = rows.map(([time]) => Number(time));
    const wanted = [...new Set([all, copy, other].flatMap((one) => one.times))].sort((a, b) => a - b);
    assert.deepEqual(times, wanted);
    for (const [prefix, one] of names) {
      const places = joints(one, prefix).map((/** @type {string} */ name) => head.indexOf(name));
      assert.ok(places.every((/** @type {number} */ place) => place > 0), `${prefix} of ${head}`);
      rows.forEach((row, i) => {
        const state = one.states[Math.max(one.times.findLastIndex((/** @type {number} */ time) => time <= (times[i] ?? NaN)), 0)];
        const shown = places.map((/** @type {number} */ place) => row[place]);
        const isThere = shown[0] !== "";
        if (isThere) assert.deepEqual(shown.map(Number), state.q);
        else assert.ok(shown.every((/** @type {string} */ value) => value === "") && prefix !== "");
      });
    }
    const there = (/** @type {string} */ name) => rows.map((row) => row[head.indexOf(name)] !== "");
    const [first, second] = [there(joints(copy, "3r 2.")[0]), there(joints(other, "ur5e.")[0])];
    assert.deepEqual([first[0], first.at(-1), second[0], second.at(-1)], [true, false, false, true]);

    // The same numbers in the plots, at the moment that is shown.
    await page.evaluate((time) => /** @type {any} */ (window).viewer.timeline.player.seek(time), times.at(-1));
    const line = (/** @type {string} */ name) => page.locator(`[data-plot="joints"] [data-line="${name}"]`);
    await line("ur5e.shoulder_pan_joint").getByText("0.2500").waitFor();
    for (const name of [...joints(all), ...joints(copy, "3r 2."), ...joints(other, "ur5e.")]) assert.equal(await line(name).count(), 1, name);
    assert.equal(await page.locator('[data-plot="singular"] [data-line="ur5e.σ6"] .dotted').count(), 1);
    const gaps = await page.evaluate(() => {
      const { plot } = /** @type {any} */ (window).viewer.timeline.plots.charts.get("joints");
      return plot.data.slice(1).map((/** @type {(number | null)[]} */ values) => [values[0] === null, values.at(-1) === null]);
    });
    assert.deepEqual(gaps, [...Array(3).fill([false, false]), ...Array(3).fill([false, true]), ...Array(6).fill([true, false])]);
    await picture(page, "beside-plots");
    // The file is one of the first model, too.
    const path = join(folder, "beside.csv");
    await writeFile(path, text);
    await openFiles(page, path);
    await page.waitForFunction((count) => /** @type {any} */ (window).viewer.timeline.recording?.length === count, rows.length);
  }, { width: 1366, height: 768 }));
