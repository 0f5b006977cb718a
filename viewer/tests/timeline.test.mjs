/** Recordings and motions of files: played, scrubbed, plotted and left. */
import assert from "node:assert/strict";
import { mkdtemp, readFile, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { apart, browserOfFile, cylindroid, enter, moveTarget, openFiles, openPanel, picture, saved, showOverlay, state, until, untilReached } from "./lib.mjs";

const { visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-timeline-"));

/**
 * A file of this text.
 * @param {string} name
 * @param {string} text
 */
async function file(name, text) {
  const path = join(folder, name);
  await writeFile(path, text);
  return path;
}

/**
 * The moment that is shown, null where it is the robot as it is.
 * @param {import("playwright-core").Page} page
 * @returns {Promise<import("../src/protocol").State | null>}
 */
const moment = (page) => page.evaluate(() => /** @type {any} */ (window).viewer.timeline.moment?.state ?? null);

/**
 * Waits until a moment is shown that is so.
 * @param {import("playwright-core").Page} page
 * @param {string} condition of `moment`
 */
const untilMoment = (page, condition) => until(page, `(() => { const moment = window.viewer.timeline.moment?.state ?? null; return ${condition}; })()`);

/** @param {import("playwright-core").Page} page */
const slider = (page) => page.getByLabel("Time of the recording [s]");

/**
 * Positions of all links as they are drawn.
 * @param {import("playwright-core").Page} page
 * @returns {Promise<number[]>}
 */
const drawn = (page) => page.evaluate(() => /** @type {any} */ (window).viewer.robot.links.flatMap((/** @type {any} */ { frame }) => frame.position.toArray()));

/**
 * Records while the tool goes down.
 * @param {import("playwright-core").Page} page
 */
async function recordMotion(page) {
  await page.getByRole("button", { name: "Record" }).click();
  await untilReached(page, await moveTarget(page, "z", -0.15));
  await page.getByRole("button", { name: /^Stop recording/ }).click();
  return JSON.parse(await saved(page, "Save the recording as JSON"));
}

test("a recording is scrubbed by keys, drawn as it was, and left; the robot does not move", () =>
  visit(["panda"], async (page) => {
    const { states, times } = await recordMotion(page);
    const end = await state(page);
    assert.equal(times.length, states.length);
    assert.ok(states.length > 20 && times.every((/** @type {number} */ time, /** @type {number} */ i) => i === 0 || time >= times[i - 1]));
    await slider(page).focus();
    await page.keyboard.press("Home");
    await untilMoment(page, `moment?.seq === ${states[0].seq}`);
    for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
    await untilMoment(page, `moment?.seq === ${states[5].seq}`);
    const shown = await moment(page);
    assert.deepEqual(shown?.q, states[5].q);
    const links = states[5].links.flatMap((/** @type {any} */ link) => link.position);
    assert.ok(apart(await drawn(page), links) < 1e-12);
    const field = page.getByLabel("panda_joint4 as a number");
    assert.ok(Math.abs(Number(await field.inputValue()) - states[5].q[3]) < 1e-4);
    const legend = page.locator('[data-plot="joints"] [data-line="panda_joint4"] .number');
    assert.equal((await legend.textContent())?.replace("−", "-"), states[5].q[3].toFixed(4));
    await openPanel(page, "mobility");
    await page.locator('[data-panel="mobility"] > .doubt').waitFor({ state: "visible" });
    assert.ok(apart((await state(page)).q, end.q) < 1e-4);
    await picture(page, "timeline");
    await slider(page).focus();
    await page.keyboard.press("End");
    await untilMoment(page, `moment?.seq === ${states.at(-1).seq}`);
    await page.getByRole("button", { name: "live" }).focus();
    await page.keyboard.press("Enter");
    await untilMoment(page, "moment === null");
    assert.ok(apart(await drawn(page), end.links.flatMap((link) => link.position)) < 1e-4);
    await page.locator('[data-panel="mobility"] > .doubt').waitFor({ state: "hidden" });
  }));

test("the numbers of axes have room, also those of rounding", () =>
  visit(["panda"], async (page) => {
    await recordMotion(page);
    for (const name of ["Joint velocities", "Error", "Distances to limits"]) await page.getByRole("button", { name, exact: true }).click();
    // An angle of rounding alone.
    const wide = await page.evaluate(() => {
      const { plots, recording } = /** @type {any} */ (window).viewer.timeline;
      const [, angles] = recording.columns.errors;
      for (let i = 0; i < angles.length; i += 1) angles.values[i] = 1e-9 * (i % 3);
      plots.draw();
      return [...plots.charts.values()].flatMap(({ kind, plot }) => plot.axes.slice(1).flatMap((/** @type {any} */ axis) => {
        const context = new OffscreenCanvas(1, 1).getContext("2d");
        if (!context) return [];
        context.font = "11px system-ui, sans-serif";
        const gone = axis._values.filter((/** @type {string} */ words) => context.measureText(words).width > axis._size);
        return [...gone, ...(axis._values.length > 0 ? [] : ["nothing"])].map((words) => `${kind.name}: ${words}`);
      }));
    });
    assert.deepEqual(wide, []);
  }));

test("a recording has the times of the server, also where the page stands still", () =>
  visit(["panda"], async (page) => {
    // At rest nothing is sent: what was before the press does not count.
    await page.waitForTimeout(1500);
    await page.getByRole("button", { name: "Record" }).click();
    const pressed = (await state(page)).clock;
    const goal = await moveTarget(page, "z", -0.15);
    await page.evaluate(() => {
      for (const end = performance.now() + 400; performance.now() < end;);
    });
    await untilReached(page, goal);
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const { states, times } = JSON.parse(await saved(page, "Save the recording as JSON"));
    assert.equal(states[0].clock, pressed);
    assert.ok(states[1].clock - pressed > 1.5 && times[0] === 0 && times[1] < states[1].clock - pressed - 1, `${times.slice(0, 2)}`);
    const moving = states.slice(1).flatMap((/** @type {any} */ { time, clock }, /** @type {number} */ i) => {
      if (i === 0) return [];
      assert.ok(Math.abs(times[i + 1] - times[i] - (clock - states[i].clock)) < 1e-9 && times[i + 1] > times[i]);
      // Beyond a tenth of a second the servo does not catch up.
      return states[i].servo.status === "moving" && clock - states[i].clock < 0.1 ? [Math.abs(times[i + 1] - times[i] - (time - states[i].time))] : [];
    });
    assert.ok(moving.length > 20 && moving.sort((/** @type {number} */ a, /** @type {number} */ b) => a - b)[Math.floor(0.9 * moving.length)] < 0.02, `${moving.slice(-5)}`);
  }));

test("undo and redo go through a recording that is shown, step by step, and move nothing", () =>
  visit(["panda"], async (page) => {
    const joint = async (/** @type {number} */ i, /** @type {number} */ value) => {
      await enter(page.getByLabel(`panda_joint${i} as a number`), value);
      await until(page, `Math.abs(state.q[${i - 1}] - ${value}) < 1e-9`);
      await page.waitForTimeout(800);
    };
    await page.getByRole("button", { name: "Record" }).click();
    const home = (await state(page)).q;
    await joint(1, 0.4);
    await joint(3, 0.3);
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    await until(page, 'document.querySelectorAll(".dock-marks .mark-step").length === 2');
    await slider(page).focus();
    await page.keyboard.press("Home");
    await page.keyboard.press("End");
    await untilMoment(page, "moment && Math.abs(moment.q[2] - 0.3) < 1e-9");
    const [undo, redo] = ["Undo", "Redo"].map((name) => page.getByRole("button", { name: new RegExp(`^${name}`) }));
    if (!undo || !redo) throw new Error("no buttons");
    assert.equal(await redo.getAttribute("aria-disabled"), "true");
    await undo.click();
    await untilMoment(page, `Math.abs(moment.q[0] - 0.4) < 1e-9 && Math.abs(moment.q[2] - ${home[2]}) < 1e-9`);
    await page.locator('canvas[role="application"]').focus();
    await page.keyboard.press("Control+z");
    await untilMoment(page, `Math.abs(moment.q[0] - ${home[0]}) < 1e-9`);
    await redo.click();
    await untilMoment(page, `Math.abs(moment.q[0] - 0.4) < 1e-9 && Math.abs(moment.q[2] - ${home[2]}) < 1e-9`);
    assert.ok(Math.abs(((await state(page)).q[2] ?? 0) - 0.3) < 1e-9, "the robot stays");
    // Back at the robot as it is, they move it.
    await page.getByRole("button", { name: "live" }).click();
    await undo.click();
    await until(page, `Math.abs(state.q[2] - ${home[2]}) < 1e-9 && Math.abs(state.q[0] - 0.4) < 1e-9`);
  }));

test("a recording plays to its end, in a loop, faster and slower", () =>
  visit(["panda"], async (page) => {
    const { states, times } = await recordMotion(page);
    const last = states.at(-1).seq;
    await page.getByLabel("Speed of playing back").selectOption("4 ×");
    await page.getByRole("button", { name: "Play back" }).click();
    await untilMoment(page, `moment?.seq > ${states[3].seq} && moment?.seq < ${last}`);
    await untilMoment(page, `moment?.seq === ${last}`);
    await page.getByRole("button", { name: "Play back" }).waitFor(); // it has ended by itself
    await page.getByRole("button", { name: "Loop" }).click();
    await page.getByRole("button", { name: "Play back" }).click();
    await untilMoment(page, `moment?.seq < ${states[Math.floor(times.length / 2)].seq}`);
    await page.getByRole("button", { name: "Pause playback" }).click();
  }));

test("marks are where limits are active and singular values are lost, the trail is the way of the tool, and plots leave as PNG", () =>
  visit(["panda"], async (page) => {
    await page.getByRole("button", { name: "Record" }).click();
    // Farther out than the arm is long: joints come to their limits, and the arm is stretched.
    await moveTarget(page, "x", 1.5);
    await until(page, 'state.servo.status === "stalled"');
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const { states, times } = JSON.parse(await saved(page, "Save the recording as JSON"));
    const isSo = {
      limit: (/** @type {any} */ { servo, outside_limits }) => servo.limits.length + outside_limits.length > 0,
      singular: (/** @type {any} */ { singular }) => singular?.values.some((/** @type {number} */ value) => value < singular.threshold),
    };
    let seen = 0;
    for (const [name, is] of Object.entries(isSo)) {
      const wanted = states.reduce((/** @type {number} */ sum, /** @type {any} */ state, /** @type {number} */ i) => sum + Number(is(state) && !(i > 0 && is(states[i - 1]))), 0);
      const drawn = await page.locator(`.dock-marks .mark-${name}`).evaluateAll((rects) => rects.map((rect) => ["x", "width"].map((key) => Number(rect.getAttribute(key)))));
      assert.equal(drawn.length, wanted, name);
      const across = await slider(page).evaluate((element) => element.clientWidth);
      for (const [x = NaN, width = NaN] of drawn) assert.ok(x >= 0 && x + width <= across + 1.5, `${name}: ${drawn} of ${across}`);
      seen += wanted;
    }
    assert.ok(seen > 0, "no mark");

    const trail = () => page.evaluate(() => {
      const line = /** @type {any} */ (window).viewer.timeline.trail.group.children[0];
      if (!line) return [];
      const [start, end] = ["instanceStart", "instanceEnd"].map((name) => line.geometry.getAttribute(name));
      const points = Array.from({ length: start.count }, (_, i) => [start.getX(i), start.getY(i), start.getZ(i)]);
      return [...points, [end.getX(end.count - 1), end.getY(end.count - 1), end.getZ(end.count - 1)]];
    });
    const [way, tools] = [await trail(), states.map((/** @type {any} */ state) => state.tool.position)];
    assert.ok(way.length > 10);
    for (const point of way) assert.ok(tools.some((/** @type {number[]} */ tool) => apart(tool, point) < 1e-6), `${point} is no place of the tool`);
    assert.ok(apart(way[0] ?? [], tools[0]) < 1e-6 && apart(way.at(-1) ?? [], tools.at(-1)) < 2e-3);
    const toggle = page.getByRole("button", { name: "Trail of the tool" });
    await toggle.click();
    assert.equal((await trail()).length, 0);
    await toggle.click();
    assert.equal((await trail()).length, way.length);

    const picture = Buffer.from(await saved(page, "Save the plots as PNG", "latin1"), "latin1");
    assert.deepEqual([...picture.subarray(0, 8)], [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
    // As wide as the plots of the page, and as high as both together.
    const [width = 0, height = 0] = await page.locator(".plots canvas").evaluateAll((all) => {
      const shown = /** @type {HTMLCanvasElement[]} */ (all);
      return [Math.max(...shown.map((one) => one.width)), shown.reduce((sum, one) => sum + one.height, 0)];
    });
    assert.equal(picture.readUInt32BE(16), width);
    // A title for each, and the names of seven joints and of six singular values in two rows at least.
    assert.ok(width > 100 && height > 100 && picture.readUInt32BE(20) >= height + 2 * (22 + 2 * 20));
    assert.equal(times.length, states.length);
  }));

test("whoever moves the robot goes on from the moment shown, and undo leads back", () =>
  visit(["panda"], async (page) => {
    const { states } = await recordMotion(page);
    const end = await state(page);
    await slider(page).focus();
    await page.keyboard.press("Home");
    await untilMoment(page, `moment?.seq === ${states[0].seq}`);
    const field = page.getByLabel("panda_joint1 as a number");
    await field.fill("0.3");
    await field.press("Enter");
    await until(page, "Math.abs(state.q[0] - 0.3) < 1e-9");
    assert.equal(await moment(page), null);
    assert.ok(apart((await state(page)).q.slice(1), states[0].q.slice(1)) < 1e-9);
    await page.getByRole("button", { name: /^Undo/ }).click();
    await until(page, `Math.abs(state.q[3] - ${end.q[3]}) < 1e-4 && Math.abs(state.q[0] - ${end.q[0]}) < 1e-4`);
  }));

test("overlays and distances that were not recorded are those of the moment shown", () =>
  visit(["panda"], async (page) => {
    const { states } = await recordMotion(page);
    await slider(page).focus();
    await page.keyboard.press("Home");
    await page.locator('[data-overlay="joint-axes"]').check();
    await openPanel(page, "distances");
    await untilMoment(page, `moment?.seq === ${states[0].seq} && moment.overlays["joint-axes"] && moment.distances`);
    const axes = (await moment(page))?.overlays["joint-axes"];
    assert.ok(axes && "axes" in axes && axes.axes.length >= 7);
  }));

/**
 * Chooses another controlled frame.
 * @param {import("playwright-core").Page} page
 */
async function otherFrame(page) {
  const name = await page.evaluate(() => {
    const { session } = /** @type {any} */ (window).viewer;
    const other = session.scene.frames.find((/** @type {any} */ one) => one.name !== session.scene.frame && one.link === 4);
    session.send({ type: "frame", name: other.name });
    return other.name;
  });
  await until(page, `scene.frame === ${JSON.stringify(name)}`);
  return name;
}

test("answers that were computed for another frame are asked for again", () =>
  visit(["panda"], async (page) => {
    const { coordinates, home } = await page.evaluate(() => /** @type {any} */ (window).viewer.session.scene);
    const heads = coordinates.map((/** @type {any} */ { name }) => name).join(",");
    const path = await file("frames.csv", [`time,${heads}`, ...Array.from({ length: 200 }, (_, i) => `${i / 100},${home.join(",")}`)].join("\n"));
    // The answer to the second question comes when it is told to.
    await page.evaluate(() => {
      const { session } = /** @type {any} */ (window).viewer;
      const receive = session.receive.bind(session);
      let answers = 0;
      session.receive = (/** @type {string} */ raw) => {
        if (raw.startsWith('{"type":"states"') && (answers += 1) === 2) Object.assign(window, { goOn: () => receive(raw) });
        else receive(raw);
      };
    });
    await openFiles(page, path);
    await page.waitForFunction(() => "goOn" in window);
    const frame = await otherFrame(page);
    await until(page, "state.servo.status !== 'moving'");
    await page.evaluate(() => /** @type {any} */ (window).goOn());
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.timeline.recording?.length === 200);
    const { tools, of } = await page.evaluate(() => {
      const { recording } = /** @type {any} */ (window).viewer.timeline;
      return { of: recording.scene.frame, tools: Array.from({ length: 200 }, (_, i) => recording.stateAt(i).tool.position) };
    });
    assert.equal(of, frame);
    const { tool } = await state(page);
    for (const one of tools) assert.ok(apart(one, tool.position) < 1e-9, `${one} is not ${tool.position}`);
  }));

test("overlays of a recording are not those of another frame", () =>
  visit(["panda"], async (page) => {
    const { states } = await recordMotion(page);
    await otherFrame(page);
    await slider(page).focus();
    await page.keyboard.press("Home");
    await untilMoment(page, `moment?.seq === ${states[0].seq}`);
    await page.locator('[data-overlay="velocity-ellipsoid"]').check();
    await page.getByText(/Overlays and distances that were not recorded are not shown/).waitFor();
    assert.equal((await moment(page))?.overlays["velocity-ellipsoid"], undefined);
    await page.getByRole("button", { name: "live" }).click();
    await until(page, 'state.overlays["velocity-ellipsoid"] !== undefined');
  }));

test("motions of move and CSV by the names of joints are opened, with what they say and what the server computes", (t) =>
  visit(["panda"], async (page) => {
    const csv = join(folder, "motion.csv");
    await cylindroid("move", "panda", "--to", "0.45,0.15,0.35", "--rpy", "3.1416,0,0.6", "--out", csv);
    await openFiles(page, csv);
    const [head = "", ...rows] = (await readFile(csv, "utf8")).trim().split("\n");
    const names = head.split(",");
    await page.waitForFunction((count) => /** @type {any} */ (window).viewer.timeline.recording?.length === count, rows.length);
    const last = (rows.at(-1) ?? "").split(",").map(Number);
    const bounded = rows.filter((row) => !row.endsWith(",")).length;
    assert.ok(bounded > 0 && names.at(-1) === "limits");
    const marks = await page.evaluate(() => [.../** @type {any} */ (window).viewer.timeline.recording.columns.marks.view()]);
    assert.equal(marks.filter((mark) => mark & 1).length, bounded, "as many marks as rows with limits");
    await slider(page).focus();
    await page.keyboard.press("End");
    await untilMoment(page, `moment?.seq === ${rows.length - 1}`);
    const shown = await moment(page);
    const of = (/** @type {string} */ name) => last[names.indexOf(name)] ?? NaN;
    assert.ok(apart(shown?.tool.position ?? [], ["x", "y", "z"].map(of)) < 1e-9);
    assert.equal(shown?.error.position, of("position_error"));
    assert.ok(Math.abs((shown?.singular?.ratio ?? 0) - of("singular_ratio")) < 1e-9);
    assert.deepEqual(shown?.servo.joint_velocities, names.filter((name) => name.startsWith("velocity.")).map(of));
    t.diagnostic(`${rows.length} samples`);
    await page.getByRole("button", { name: "Joint velocities" }).click();
    await page.getByRole("button", { name: "Distances to limits" }).click();
    await page.locator('[data-plot="rates"] [data-line="panda_joint2"]').waitFor();
    await picture(page, "timeline-file");
    const own = await file("own.csv", "time,panda_joint2\n0,0\n");
    await openFiles(page, own);
    await page.getByText(/own\.csv, line 1: no column for panda_joint1/).waitFor();
    const { coordinates } = await page.evaluate(() => /** @type {any} */ (window).viewer.session.scene);
    const heads = coordinates.map((/** @type {any} */ { name }) => name).join(",");
    const zeros = coordinates.map(() => "0").join(",");
    // Without velocities, they are differences.
    await openFiles(page, await file("positions.csv", `time,${heads}\n0,${zeros}\n0.5,0.2${zeros.slice(1)}\n`));
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.timeline.recording?.length === 2);
    assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).viewer.timeline.recording.columns.rates.map((/** @type {any} */ rate) => rate.at(1))), [0.4, ...coordinates.slice(1).map(() => 0)]);
    await page.locator('[data-plot="rates"]').getByText("differences of positions").waitFor();
    await openFiles(page, csv);
    await page.waitForFunction((count) => /** @type {any} */ (window).viewer.timeline.recording?.length === count, rows.length);
    await slider(page).focus();
    await page.keyboard.press("End");
    await untilMoment(page, `moment?.seq === ${rows.length - 1}`);
    for (const [name, text, told] of /** @type {const} */ ([
      ["word.csv", `time,${heads}\n0,${zeros}\n0.1,${zeros.replace("0", "none")}\n`, /word\.csv, line 3: "none" in column panda_joint1 is not a number/],
      ["back.csv", `time,${heads}\n1,${zeros}\n0.5,${zeros}\n`, /back\.csv, line 3: its time is before/],
      ["short.csv", `time,${heads}\n0,1\n`, /short\.csv, line 2 has 2 cells, not/],
      ["empty.csv", `time,${heads}\n`, /empty\.csv has no sample/],
      ["broken.json", "{", /broken\.json is not JSON/],
      ["other.json", '{"model": "ur5e", "joint_names": ["a"], "samples": []}', /other\.json is a motion of ur5e without panda_joint1/],
      ["none.json", "{}", /none\.json has neither "samples"/],
    ])) {
      await openFiles(page, await file(name, text));
      await page.getByText(told).waitFor();
    }
    // What was open still is.
    await untilMoment(page, `moment?.seq === ${rows.length - 1}`);
  }));

test("a file that is dropped is opened; a recording that was saved comes back the same", () =>
  visit(["five-bar"], async (page) => {
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await until(page, 'scene.task.components.join() === "x,y"');
    await page.getByRole("button", { name: "Record" }).click();
    await untilReached(page, await moveTarget(page, "y", -0.4));
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const text = await saved(page, "Save the recording as JSON");
    const { states } = JSON.parse(text);
    const transfer = await page.evaluateHandle((content) => {
      const data = new DataTransfer();
      data.items.add(new File([content], "again.json", { type: "application/json" }));
      return data;
    }, text);
    for (const type of ["dragover", "drop"]) await page.dispatchEvent("canvas", type, { dataTransfer: transfer });
    await page.waitForFunction((count) => {
      const { recording } = /** @type {any} */ (window).viewer.timeline;
      return recording?.file === "again.json" && recording.length === count;
    }, states.length);
    await slider(page).focus();
    await page.keyboard.press("End");
    await untilMoment(page, `moment?.seq === ${states.length - 1}`);
    const [shown, was] = [await moment(page), states.at(-1)];
    assert.ok(apart(shown?.q ?? [], was.q) < 1e-15);
    assert.deepEqual(shown?.target, was.target);
    assert.ok(apart(shown?.links.flatMap((link) => link.position) ?? [], was.links.flatMap((/** @type {any} */ link) => link.position)) < 1e-12);
    assert.ok(apart(shown?.singular?.values ?? [], was.singular.values) < 1e-9);
  }));

test("10 000 states are scrubbed", (t) =>
  visit(["panda"], async (page) => {
    await showOverlay(page, "velocity-ellipsoid");
    await page.locator('[data-overlay="velocity-ellipsoid"]').uncheck();
    const { coordinates, home } = await page.evaluate(() => /** @type {any} */ (window).viewer.session.scene);
    const rows = Array.from({ length: 10_000 }, (_, i) => [i / 100, ...home.map((/** @type {number} */ q, /** @type {number} */ k) => q + (k < 7 ? 0.1 * Math.sin(i / 150 + k) : 0))].join(","));
    const path = await file("long.csv", [["time", ...coordinates.map((/** @type {any} */ { name }) => name)].join(","), ...rows].join("\n"));
    const begin = performance.now();
    await openFiles(page, path);
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.timeline.recording?.length === 10_000);
    t.diagnostic(`opened in ${((performance.now() - begin) / 1000).toFixed(1)} s`);
    await page.getByRole("button", { name: "Distances to limits" }).click();
    const { work, intervals, perFrame } = await page.evaluate(async () => {
      const { timeline, session } = /** @type {any} */ (window).viewer;
      let spent = 0;
      for (const [of, name] of [[timeline, "flush"], [timeline, "answered"], [timeline.player, "seek"], [session, "receive"]]) {
        const work = of[name].bind(of);
        of[name] = (/** @type {any[]} */ ...given) => {
          const begin = performance.now();
          work(...given);
          spent += performance.now() - begin;
        };
      }
      const work = [];
      for (let i = 0; i < 100; i += 1) {
        spent = 0;
        timeline.player.seek((i * 37) % 100);
        while (timeline.wanted !== null || timeline.asking) await new Promise((resolve) => requestAnimationFrame(resolve));
        work.push(spent);
      }
      // As one who drags the slider: another moment with every frame, whether the last one has come or not.
      /** @type {{ interval: number, work: number }[]} */
      const frames = [];
      const frame = () => /** @type {Promise<number>} */ (new Promise((resolve) => requestAnimationFrame(resolve)));
      let last = await frame();
      for (let [i, end] = [0, last + 3000]; last < end; i += 1) {
        spent = 0;
        timeline.player.seek((i * 37) % 100);
        const now = await frame();
        frames.push({ interval: now - last, work: spent });
        last = now;
      }
      return { work, intervals: frames.map(({ interval }) => interval), perFrame: frames.map((one) => one.work) };
    });
    const at = (/** @type {number[]} */ all, /** @type {number} */ share) => ([...all].sort((a, b) => a - b)[Math.floor(share * (all.length - 1))] ?? NaN).toFixed(2);
    const words = (/** @type {number[]} */ all) => `${at(all, 0.5)} ms (median), ${at(all, 0.95)} ms (95 %)`;
    t.diagnostic(`JavaScript for a state of 10 000: ${words(work)}, three plots`);
    t.diagnostic(`scrubbed for 3 s: JavaScript for a frame ${words(perFrame)}; between ${intervals.length} frames ${words(intervals)}`);
    // A mark that the page keeps, with room for a machine that does other things.
    assert.ok(Number(at(work, 0.5)) < 5, words(work));
    await slider(page).focus();
    await page.keyboard.press("PageDown");
    await page.keyboard.press("ArrowRight");
    await untilMoment(page, "moment !== null");
    await picture(page, "timeline-long");
  }));
