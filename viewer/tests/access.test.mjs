/** For everybody: axe-core finds no violation, light and dark, wide and narrow; every action has a key. */
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { apart, BINARY, browserOfFile, moveTarget, openFiles, openPanel, picture, saved, served, showOverlay, until } from "./lib.mjs";

const { look, visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-access-"));

const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));
const PANELS = ["joints", "show", "model", "obstacles", "servo", "units", "pose", "singular", "distances", "screws", "mobility", "capability", "compare"];

/**
 * What axe-core finds, best practices among it.
 * @param {import("playwright-core").Page} page
 * @returns {Promise<string[]>}
 */
async function violations(page) {
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const { violations: found } = await /** @type {any} */ (window).axe.run(document, { resultTypes: ["violations"] });
    return found.flatMap((/** @type {any} */ one) => one.nodes.map((/** @type {any} */ node) => `${one.id}: ${node.target.join(" ")} ${node.failureSummary}`));
  });
}

/** Width, height, and whether it is dark. The first two are those of every model. */
const LOOKS = /** @type {const} */ ([
  [1366, 768, false], [390, 844, true], [1366, 768, true], [390, 844, false], [844, 390, true], [844, 390, false],
  [1100, 700, false], [1100, 700, true], [1920, 1080, true], [1920, 1080, false],
]);
/** @type {[string, string[], number][]} */
const MODELS = [
  ["an arm among obstacles", [CELL, "--obstacle", "ball=sphere:0.08@0.4,0.25,0.3", "--obstacle", "box=box:0.1,0.2,0.3@0.7,0.6,0.3"], LOOKS.length],
  ["a planar closed chain", ["five-bar"], 2],
  ["a platform", ["stewart"], 2],
];

for (const [words, args, looks] of MODELS) {
  test(`axe-core finds no violation: ${words}`, () =>
    served(args, async ({ url }) => {
      for (const [width, height, dark] of LOOKS.slice(0, looks)) {
        await look(url, async (page) => {
          assert.deepEqual(await violations(page), [], "as it opens");
          for (const name of PANELS) await openPanel(page, name);
          for (const name of ["velocity-ellipsoid", "principal-screws", "lost-direction"]) await showOverlay(page, name);
          await page.getByLabel("Orientation", { exact: true }).selectOption("roll, pitch, yaw");
          await page.locator('[data-panel="mobility"] dl').first().waitFor();
          await page.getByRole("treeitem").nth(1).click();
          await page.evaluate(() => /** @type {any} */ (window).viewer.companions.add(null));
          await openPanel(page, "beside-1");
          await page.getByRole("button", { name: "Record" }).click();
          // A refused message shows a notice.
          await page.evaluate(() => /** @type {any} */ (window).viewer.session.send({ type: "joint", name: "nothing", value: 0 }));
          await page.locator(".toast.bad").waitFor();
          assert.deepEqual(await violations(page), [], "all panels open");
          await page.getByRole("button", { name: /^Stop recording/ }).click();
          for (const name of ["Joint velocities", "Error", "Distances to limits"]) await page.getByRole("button", { name, exact: true }).click();
          await page.getByLabel("Time of the recording [s]").press("Home");
          await page.waitForFunction(() => /** @type {any} */ (window).viewer.timeline.moment);
          assert.deepEqual(await violations(page), [], "with a recording");
        }, { width, height, dark });
      }
    }));
}

for (const dark of [false, true]) {
  const options = { dark, width: 1366, height: 768, expect: /422/ };
  const words = dark ? "dark" : "light";

  test(`axe-core finds no violation: the dialogue, a map and a page that plays by itself, ${words}`, () =>
    visit(["panda"], async (page) => {
      await page.getByRole("button", { name: "Open a file" }).click();
      await page.locator("dialog").getByText("Catalogue").waitFor();
      assert.deepEqual(await violations(page), [], "the dialogue");
      await writeFile(join(folder, "broken.urdf"), '<robot name="broken">\n  <link name="base">\n</robot>\n');
      await openFiles(page, join(folder, "broken.urdf"));
      await page.locator("dialog .problem code").waitFor();
      assert.deepEqual(await violations(page), [], "a refusal");
      await promisify(execFile)(BINARY, ["sweep", "panda", "--samples", "300", "--quantities", "pose,yoshikawa", "--out", `${words}.csv`], { cwd: folder });
      await openFiles(page, join(folder, `${words}.csv`));
      await page.locator('[data-panel="map"]').getByText(`${words}.csv, 300 points`).waitFor();
      assert.deepEqual(await violations(page), [], "a map");
      await page.getByRole("button", { name: "Record" }).click();
      await moveTarget(page, "z", -0.03);
      await page.getByRole("button", { name: /^Stop recording/ }).click();
      const path = join(folder, `${words}.html`);
      await writeFile(path, await saved(page, "Save HTML that plays the recording by itself"));
      const film = await page.context().newPage();
      await film.goto(pathToFileURL(path).href);
      await film.waitForFunction(() => /** @type {any} */ (window).film?.stage.frames > 1);
      const plots = film.getByRole("group", { name: "Plots shown" }).getByRole("button");
      for (const plot of await plots.all()) if ((await plot.getAttribute("aria-pressed")) === "false") await plot.click();
      for (const [width, height] of LOOKS.filter(([, , isDark]) => isDark === dark)) {
        const size = `${width} x ${height}`;
        await film.setViewportSize({ width, height });
        assert.deepEqual(await violations(film), [], `the page of a recording, ${size}`);
        await film.getByRole("button", { name: "Loop" }).click();
        await film.getByRole("button", { name: "Play back" }).click();
        assert.deepEqual(await violations(film), [], `the page of a recording that plays, ${size}`);
        await film.getByRole("button", { name: "Pause playback" }).click();
        await film.getByRole("button", { name: "Loop" }).click();
        await picture(film, `film-${width}-${words}`);
      }
    }, options));

  test(`axe-core finds no violation: an observer, ${words}`, () =>
    served(["panda"], ({ url }) =>
      look(`${url}?session=access`, () =>
        look(`${url}?session=access`, async (observer) => {
          await observer.locator(".role").getByText("Observing, 2 pages").waitFor();
          for (const name of PANELS) await openPanel(observer, name);
          assert.deepEqual(await violations(observer), []);
        }, options))));
}

test("axe-core finds no violation beside a stopped server", () =>
  visit(["panda"], async (page, server) => {
    await server.stop();
    await page.getByText("The server has stopped.").waitFor();
    assert.deepEqual(await violations(page), []);
  }, { expect: /WebSocket|net::ERR_/ }));

for (const [width, height] of /** @type {const} */ ([[1366, 768], [844, 390], [390, 844]])) {
  test(`Tab reaches every control once, in sight and with a mark of the focus, ${width} x ${height}`, () =>
    visit([CELL, "--obstacle", "ball=sphere:0.08@0.4,0.25,0.3"], async (page) => {
      for (const name of PANELS) await openPanel(page, name);
      await showOverlay(page, "velocity-ellipsoid");
      await page.getByRole("treeitem").nth(1).click();
      await page.evaluate(() => /** @type {any} */ (window).viewer.companions.add(null));
      await page.locator('[data-panel="beside"] [data-joint]').first().waitFor({ state: "attached" });
      await page.getByRole("button", { name: "Record" }).click();
      await page.getByRole("button", { name: /^Stop recording/ }).click();
      await page.locator('[data-panel="compare"] table').waitFor();
      await page.evaluate(() => scrollTo(0, 0));
      const wanted = await page.evaluate(() => {
        const all = [...document.querySelectorAll("button, input, select, summary, canvas[tabindex], [tabindex]")].filter((element) => {
          const { disabled } = /** @type {HTMLInputElement} */ (element);
          return !disabled && element.checkVisibility() && !element.closest(".pad");
        });
        const seen = { all: new Set(all), hidden: [], unmarked: [] };
        Object.assign(window, { seen });
        return all.length;
      });
      for (let i = 0; i < wanted + 2; i += 1) {
        await page.keyboard.press("Tab");
        await page.evaluate(() => {
          const element = document.activeElement;
          const { all, hidden, unmarked } = /** @type {any} */ (window).seen;
          if (!element || element === document.body || !all.delete(element)) return;
          const box = element.getBoundingClientRect();
          const isSeen = [0.5, 0.1].some((share) => {
            const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height * share);
            return top && (element.contains(top) || top.contains(element));
          });
          const name = `${element.tagName} ${element.getAttribute("aria-label") ?? element.textContent}`;
          if (!isSeen) hidden.push(name);
          const { outlineStyle, outlineWidth } = getComputedStyle(element);
          if (outlineStyle === "none" || parseFloat(outlineWidth) < 2) unmarked.push(name);
        });
      }
      const { missed, hidden, unmarked } = await page.evaluate(() => {
        const { all, ...rest } = /** @type {any} */ (window).seen;
        return { missed: [...all].map((/** @type {Element} */ element) => element.outerHTML.slice(0, 100)), ...rest };
      });
      assert.deepEqual({ missed, hidden, unmarked }, { missed: [], hidden: [], unmarked: [] });
    }, { width, height }));
}

test("the view is turned, moved and zoomed by keys; the handle, panels and obstacles have theirs", () =>
  visit([CELL], async (page) => {
    await page.locator("canvas").focus();
    const camera = () => page.evaluate(() => {
      const { camera: { position }, orbit: { target } } = /** @type {any} */ (window).viewer.stage;
      return { target: target.toArray(), distance: position.distanceTo(target), way: position.clone().sub(target).normalize().toArray() };
    });
    const first = await camera();
    await page.keyboard.press("+");
    const near = await camera();
    assert.ok(Math.abs(near.distance - first.distance / 1.15) < 1e-9 * first.distance && apart(near.way, first.way) < 1e-9);
    await page.keyboard.press("-");
    assert.ok(Math.abs((await camera()).distance - first.distance) < 1e-9 * first.distance);
    await page.keyboard.press("Shift+ArrowRight");
    assert.ok(apart((await camera()).way, first.way) > 0.01);
    await page.keyboard.press("ArrowRight");
    assert.ok(apart((await camera()).target, first.target) > 1e-4);
    await page.keyboard.press("e");
    await page.getByRole("button", { name: "Rotate", exact: true, pressed: true }).waitFor();
    await page.keyboard.press("w");
    await page.keyboard.press("x");
    await page.getByRole("button", { name: "tool axes", pressed: true }).waitFor();
    const summary = page.locator('[data-panel="obstacles"] > summary');
    await summary.focus();
    await page.keyboard.press("Enter");
    const panel = page.locator('[data-panel="obstacles"][open]');
    await panel.getByRole("button", { name: "Add" }).focus();
    await page.keyboard.press("Enter");
    await until(page, "scene.obstacles.length === 1 && state.obstacles.length === 1");
    await panel.getByRole("button", { name: "sphere 1", exact: true, pressed: true }).waitFor();
    await page.keyboard.press("Escape");
    await panel.getByRole("button", { name: "sphere 1", exact: true, pressed: false }).waitFor();
  }));
