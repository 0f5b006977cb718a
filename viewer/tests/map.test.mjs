/** Maps of sweeps: points in the view that are coloured, cut and clicked. */
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";
import { apart, BINARY, browserOfFile, enter, openFiles, picture, scene, state, until } from "./lib.mjs";

/** @typedef {import("playwright-core").Page} Page */

const { visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-map-"));
const run = (/** @type {string[]} */ ...args) => promisify(execFile)(BINARY, args, { cwd: folder });
const QUANTITIES = ["--quantities", "pose,yoshikawa,limit_distance"];

/**
 * What the page has read, by columns.
 * @param {Page} page
 * @returns {Promise<Record<string, number[]>>}
 */
const table = (page) => page.evaluate(() => Object.fromEntries([.../** @type {any} */ (window).viewer.map.table.columns].map(([name, values]) => [name, [...values]])));

/**
 * Where a point of the map is seen, if nothing of the map is in front of it.
 * @param {Page} page
 * @param {number} row
 * @returns {Promise<{ x: number, y: number }>}
 */
const seen = (page, row) => page.evaluate((row) => {
  const { map, project, stage } = /** @type {any} */ (window).viewer;
  const { columns } = map.table;
  const [x, y] = project(["x", "y", "z"].map((axis) => columns.get(axis)?.[row] ?? 0));
  const box = stage.renderer.domElement.getBoundingClientRect();
  return { x: box.left + ((x + 1) / 2) * box.width, y: box.top + ((1 - y) / 2) * box.height };
}, row);

/**
 * Coordinates of the points of each curve that is drawn.
 * @param {Page} page
 * @returns {Promise<number[][]>}
 */
const curves = (page) => page.evaluate(() => /** @type {any} */ (window).viewer.map.loci.group.children.map((/** @type {any} */ line) => {
  const [start, end] = ["instanceStart", "instanceEnd"].map((name) => line.geometry.getAttribute(name));
  const points = Array.from({ length: start.count }, (_, i) => [start.getX(i), start.getY(i), start.getZ(i)]);
  return [...points, [end.getX(end.count - 1), end.getY(end.count - 1), end.getZ(end.count - 1)]].flat();
}));

test("a part of a sweep is drawn, coloured and cut; a click on a point moves the robot there", () =>
  visit(["panda"], async (page) => {
    await run("sweep", "panda", "--samples", "3000", ...QUANTITIES, "--out", "sweep");
    await openFiles(page, join(folder, "sweep/part-000000.parquet"));
    const panel = page.locator('[data-panel="map"]');
    await panel.getByText("part-000000.parquet, 3000 points").waitFor();
    await run("sweep", "panda", "--samples", "3000", ...QUANTITIES, "--out", "sweep.csv");
    const [head = "", ...rows] = (await readFile(join(folder, "sweep.csv"), "utf8")).trim().split("\n");
    const columns = await table(page);
    for (const [k, name] of head.split(",").entries()) assert.ok(apart(columns[name] ?? [], rows.map((row) => Number(row.split(",")[k]))) < 1e-12, name);
    assert.equal(await panel.getByLabel("Colour", { exact: true }).inputValue(), "yoshikawa");
    await picture(page, "map");

    // Of a cut map the points beyond are neither drawn nor clicked.
    await panel.getByLabel("Cut", { exact: true }).selectOption("x");
    await page.getByLabel("Place of the cut [m]").fill("0");
    await picture(page, "map-cut");
    const inFront = await page.evaluate(() => {
      const { map, stage } = /** @type {any} */ (window).viewer;
      const box = stage.renderer.domElement.getBoundingClientRect();
      const found = new Set();
      for (let x = 0; x < box.width; x += 6) for (let y = 60; y < box.height; y += 6) found.add(map.cloud.at({ clientX: box.left + x, clientY: box.top + y }, stage.eye.position)?.row ?? null);
      return [...found].filter((row) => row !== null);
    });
    assert.ok(inFront.length > 100);
    assert.ok(inFront.every((row) => (columns["x"]?.[row] ?? 1) <= 1e-6));
    await panel.getByLabel("Cut", { exact: true }).selectOption("");

    // The robot comes to a point that is clicked, and its tool is there.
    const { coordinates } = await scene(page);
    const row = await page.evaluate(() => {
      const { map, stage, target, project } = /** @type {any} */ (window).viewer;
      const box = stage.renderer.domElement.getBoundingClientRect();
      const [hx, hy] = project(target.gizmo.object.position.toArray());
      // Away from the handle, which is dragged.
      for (let x = 40; x < box.width - 40; x += 5) {
        for (let y = 80; y < box.height - 40; y += 5) {
          const far = Math.hypot(x - ((hx + 1) / 2) * box.width, y - ((1 - hy) / 2) * box.height) > 150;
          const found = far ? map.cloud.at({ clientX: box.left + x, clientY: box.top + y }, stage.eye.position) : null;
          if (found) return found.row;
        }
      }
      return -1;
    });
    const at = await seen(page, row);
    await page.mouse.click(at.x, at.y);
    await panel.getByText(/^Point \d+: /).waitFor();
    const number = Number(/\d+/.exec(await panel.getByText(/^Point \d+: /).innerText())?.[0]);
    const q = coordinates.map(({ name }) => columns[name]?.[number] ?? NaN);
    await until(page, `Math.abs(state.q[0] - ${q[0]}) < 1e-9`);
    const now = await state(page);
    assert.ok(apart(now.q, q) < 1e-9);
    assert.ok(apart(now.tool.position, ["x", "y", "z"].map((name) => columns[name]?.[number] ?? NaN)) < 1e-9);
    // By keys: the number of a point, and the extremes of what colours.
    const reaches = async (/** @type {number} */ wanted) => {
      const q = coordinates.map(({ name }) => columns[name]?.[wanted] ?? NaN);
      await until(page, `Math.abs(state.q[0] - ${q[0]}) < 1e-9 && Math.abs(state.q[1] - ${q[1]}) < 1e-9`);
      await panel.getByText(new RegExp(`^Point ${columns["index"]?.[wanted]}: `)).waitFor();
    };
    await enter(panel.getByLabel("Number of a point"), 17);
    await reaches(columns["index"]?.indexOf(17) ?? -1);
    const values = columns["yoshikawa"] ?? [];
    for (const [name, value] of /** @type {[string, number][]} */ ([["Largest", Math.max(...values)], ["Smallest", Math.min(...values)]])) {
      await panel.getByRole("button", { name }).focus();
      await page.keyboard.press("Enter");
      await reaches(values.indexOf(value));
      assert.equal(Number(await panel.getByLabel("Number of a point").inputValue()), columns["index"]?.[values.indexOf(value)]);
    }
    await enter(panel.getByLabel("Number of a point"), 3000);
    await page.getByText("part-000000.parquet has no point 3000.").waitFor();
    // Nothing behind the point is selected.
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).viewer.selection.selected ?? null), null);
    await picture(page, "map-clicked");
    await panel.getByRole("button", { name: "Remove" }).click();
    await panel.waitFor({ state: "hidden" });
    assert.equal(await page.evaluate(() => /** @type {any} */ (window).viewer.map.cloud.group.children.length), 1, "the empty group of loci");
  }));

test("points relative to a frame say so", () =>
  visit(["panda"], async (page) => {
    const words = page.locator('[data-panel="map"]').getByText("Places are relative to link4, not to the world");
    for (const base of [["--relative-to", "link4"], []]) {
      await run("sweep", "panda", "--samples", "50", "--frame", "hand_tcp", ...base, "--quantities", "pose", "--out", `relative${base.length}`);
      await openFiles(page, join(folder, `relative${base.length}/part-000000.parquet`));
      await words.waitFor({ state: base.length > 0 ? "visible" : "hidden" });
    }
  }));

test("the file of a map is drawn in the plane of its mechanism", () =>
  visit(["five-bar"], async (page) => {
    await run("map", "five-bar", "--over", "x=-1:3.5:30", "--over", "y=-2.6:2.6:30", "--out", "map.json");
    await openFiles(page, join(folder, "map.json"));
    await page.locator('[data-panel="map"]').getByText(/map\.json, \d+ points/).waitFor();
    const columns = await table(page);
    assert.ok(columns["type_two"] && columns["mode"] && !columns["z"]);
    // Its loci are curves, of the kinds that the file has.
    const { loci } = JSON.parse(await readFile(join(folder, "map.json"), "utf8"));
    const long = loci.filter((/** @type {any} */ { points }) => points.length > 1);
    const drawn = await curves(page);
    assert.equal(drawn.length, long.length);
    assert.ok(long.length > 3);
    for (const [i, { points }] of long.entries()) assert.ok(apart(drawn[i] ?? [], points.flatMap((/** @type {number[]} */ point) => [...point, 0])) < 1e-6, `curve ${i}`);
    for (const kind of new Set(long.map((/** @type {any} */ locus) => locus.kind))) {
      const count = long.filter((/** @type {any} */ locus) => locus.kind === kind).length;
      await page.locator('[data-panel="map"]').getByText(`${kind}: ${count} curve${count > 1 ? "s" : ""}`, { exact: true }).waitFor();
    }
    await page.locator('[data-panel="map"]').getByLabel("Colour", { exact: true }).selectOption("type_two");
    await picture(page, "map-five-bar");
  }));

test("a map at a height is drawn at that height, also one without y", () =>
  visit(["stewart"], async (page) => {
    for (const [over, held] of /** @type {const} */ ([[["x=-0.2:0.2:5", "y=-0.2:0.2:5"], "z=1.1"], [["x=-0.2:0.2:5", "z=0.9:1.1:5"], "y=0.05"]])) {
      const [name, value] = held.split("=");
      await run("map", "stewart", ...over.flatMap((axis) => ["--over", axis]), "--at", held, "--starts", "1", "--out", "high.json");
      await openFiles(page, join(folder, "high.json"));
      await page.waitForFunction(([column, wanted]) => /** @type {any} */ (window).viewer.map.table?.columns.get(column)?.every((/** @type {number} */ x) => Math.abs(x - Number(wanted)) < 1e-12), /** @type {const} */ ([name, value]));
      const { rows } = JSON.parse(await readFile(join(folder, "high.json"), "utf8"));
      const places = await page.evaluate(() => [.../** @type {any} */ (window).viewer.map.cloud.points.geometry.getAttribute("position").array]);
      assert.equal(places.length, 3 * rows.length);
      const axis = "xyz".indexOf(name ?? "");
      for (let i = axis; i < places.length; i += 3) assert.ok(Math.abs(places[i] - Number(value)) < 1e-6);
      for (const points of await curves(page)) for (let i = axis; i < points.length; i += 3) assert.ok(Math.abs((points[i] ?? NaN) - Number(value)) < 1e-6);
    }
  }));

test("tables that are no maps say so, and motions stay motions", () =>
  visit(["panda"], async (page) => {
    await run("sweep", "panda", "--samples", "100", "--quantities", "yoshikawa", "--out", "without");
    await openFiles(page, join(folder, "without/part-000000.parquet"));
    await page.getByText('has no columns x and y: add the quantity "pose" to the sweep.').waitFor();
    await writeFile(join(folder, "no.parquet"), "PAR1 and nothing else");
    await openFiles(page, join(folder, "no.parquet"));
    await page.getByText("no.parquet is no Parquet file that can be read").waitFor();
    await writeFile(join(folder, "short.csv"), "index,x,y,z\n0,1,2,3\n1,2\n");
    await openFiles(page, join(folder, "short.csv"));
    await page.getByText("short.csv, row 2 has 2 cells, not 4.").waitFor();
    await run("move", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6", "--out", "motion.csv");
    await openFiles(page, join(folder, "motion.csv"));
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.timeline.recording?.length > 5);
    assert.ok(await page.locator('[data-panel="map"]').isHidden());
  }));
