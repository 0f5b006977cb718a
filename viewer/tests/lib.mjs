/** What the tests share: the real server, a headless browser, the command line. */
import assert from "node:assert/strict";
import { execFile, spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before } from "node:test";
import { promisify } from "node:util";
import { chromium } from "playwright-core";

/** @typedef {import("playwright-core").Page} Page */
/** @typedef {import("playwright-core").Browser} Browser */
/** @typedef {{ dark?: boolean, width?: number, height?: number, expect?: RegExp }} Look */

export const BINARY = process.env["CYLINDROID_BINARY"] ?? "";
export const ROBOTS = process.env["CYLINDROID_TEST_ROBOTS"] ?? "";
const SCREENSHOTS = process.env["CYLINDROID_SCREENSHOTS"] ?? "";
if (!existsSync(BINARY)) throw new Error("run these tests by `cargo xtask viewer --test`: they need its binary and robots");

/** Generous: pixels are made by the processor, and other work may go on beside. */
export const PATIENCE = Number(process.env["CYLINDROID_PATIENCE"] ?? 60_000);

/**
 * `cylindroid view`, until it is stopped.
 * @param {string[]} args
 */
export async function serve(...args) {
  // A port of its own: what the browser keeps of an address is that of this server.
  const port = args.includes("--port") ? [] : ["--port", "0"];
  const child = spawn(BINARY, ["view", ...port, ...args], { stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  child.stderr.on("data", (data) => (said += data));
  const url = await new Promise((resolve, reject) => {
    let out = "";
    child.stdout.on("data", (data) => {
      out += data;
      const found = /http:\/\/\S+/.exec(out)?.[0];
      if (found) resolve(found);
    });
    child.on("exit", (code) => reject(new Error(`view ended with ${code}: ${said}`)));
  });
  return {
    url: /** @type {string} */ (url),
    async stop() {
      if (child.exitCode !== null || child.signalCode !== null) return;
      const gone = new Promise((resolve) => child.once("exit", resolve));
      child.kill("SIGKILL");
      await gone;
    },
  };
}

/** @typedef {Awaited<ReturnType<typeof serve>>} Server */

/**
 * `cylindroid view` while some work is done.
 * @param {string[]} args
 * @param {(server: Server) => Promise<void>} work
 */
export async function served(args, work) {
  const server = await serve(...args);
  try {
    await work(server);
  } finally {
    await server.stop();
  }
}

/**
 * A browser without a window; WebGL by the processor.
 * @param {string[]} more
 */
export function launch(...more) {
  return chromium.launch({
    executablePath: process.env["CYLINDROID_CHROMIUM"] ?? "/usr/bin/chromium",
    args: [
      "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", ...more,
    ],
  });
}

/** One browser for the tests of a file, and the two ways to use it. */
export function browserOfFile() {
  /** @type {Browser} */
  let browser;
  before(async () => {
    browser = await launch();
  });
  after(() => browser.close());
  /**
   * A page at an address. An error in its console fails the test.
   * @param {string} url
   * @param {(page: Page) => Promise<void>} work
   * @param {Look} [options]
   */
  async function look(url, work, options) {
    const { page, troubles, close } = await open(browser, url, options);
    try {
      await work(page);
      assert.deepEqual(troubles, []);
    } finally {
      await close();
    }
  }
  /**
   * A page at a server of its own.
   * @param {string[]} args of `cylindroid view`
   * @param {(page: Page, server: Server) => Promise<void>} work
   * @param {Look} [options]
   */
  const visit = (args, work, options) => served(args, (server) => look(server.url, (page) => work(page, server), options));
  return { look, visit };
}

/**
 * A page of the viewer that has drawn its robot. `troubles` collects what the console calls errors but those expected.
 * @param {Browser} browser
 * @param {string} url
 * @param {Look} [look]
 */
export async function open(browser, url, { dark = false, width = 960, height = 540, expect } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: dark ? "dark" : "light", acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  /** @type {string[]} */
  const troubles = [];
  const note = (/** @type {string} */ trouble) => {
    if (!expect?.test(trouble)) troubles.push(trouble);
  };
  page.on("console", (message) => {
    if (message.type() === "error") note(`${message.text()} ${message.location().url}`);
  });
  page.on("pageerror", (error) => note(String(error)));
  await page.goto(url);
  await drawn(page);
  return { page, troubles, close: () => context.close() };
}

/**
 * Waits until a state has been drawn.
 * @param {Page} page
 */
export async function drawn(page) {
  await page.waitForFunction(() => {
    const viewer = /** @type {any} */ (window).viewer;
    return viewer?.session.state && viewer.stage.frames > 1;
  });
}

/**
 * A picture that is kept.
 * @param {Page} page
 * @param {string} name
 */
export async function picture(page, name) {
  if (SCREENSHOTS) await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`) });
}

/**
 * What a command prints with `--json`; exit code 1 is a negative answer, no failure.
 * @param {string[]} args
 * @returns {Promise<any>}
 */
export async function cylindroid(...args) {
  try {
    const { stdout } = await promisify(execFile)(BINARY, [...args, "--json"], { maxBuffer: 1 << 26 });
    return JSON.parse(stdout);
  } catch (error) {
    const failed = /** @type {{ code?: number, stdout?: string }} */ (error);
    if (failed.code === 1 && failed.stdout) return JSON.parse(failed.stdout);
    throw error;
  }
}

/**
 * The state that was drawn last.
 * @param {Page} page
 * @returns {Promise<import("../src/protocol").State>}
 */
export function state(page) {
  return page.evaluate(() => /** @type {any} */ (window).viewer.session.state);
}

/**
 * @param {Page} page
 * @returns {Promise<import("../src/protocol").Scene>}
 */
export function scene(page) {
  return page.evaluate(() => /** @type {any} */ (window).viewer.session.scene);
}

/**
 * Waits until what is drawn satisfies a condition. Asked from here: the page's policy forbids it to evaluate words.
 * A condition that was true before the action it waits for shows nothing: name what the action changes.
 * @param {Page} page
 * @param {string} condition of `state` and `scene`
 */
export async function until(page, condition) {
  const end = performance.now() + PATIENCE;
  const asked = `(() => { const { scene, state } = window.viewer.session; return Boolean(scene && state && (${condition})); })()`;
  while (!(await page.evaluate(asked))) {
    if (performance.now() > end) {
      const { servo, error, q } = await state(page);
      throw new Error(`never came: ${condition}; last ${JSON.stringify({ servo, error, q })}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/**
 * Waits until numbers of what is drawn are these.
 * @param {Page} page
 * @param {string} path to a list, from `state` or `scene`
 * @param {number[]} wanted
 * @param {number} [tolerance]
 */
export function untilNear(page, path, wanted, tolerance = 1e-9) {
  const list = JSON.stringify(wanted);
  return until(page, `${path}.length === ${wanted.length} && ${path}.every((value, i) => Math.abs(value - ${list}[i]) <= ${tolerance})`);
}

/**
 * Waits until the server has this target and the tool is at it.
 * @param {Page} page
 * @param {number[]} target its position (m)
 */
export async function untilReached(page, target) {
  await untilNear(page, "state.target.position", target, 1e-6);
  await until(page, 'state.servo.status === "reached" && state.error.position < 1e-3 && state.error.orientation < 1e-3');
}

/**
 * Types a value in, as one does who then presses Enter.
 * @param {import("playwright-core").Locator} field
 * @param {number} value
 */
export async function enter(field, value) {
  await field.fill(String(value));
  await field.press("Enter");
}

/**
 * Moves the target by its fields; waits until the server has it, and gives where it is.
 * @param {Page} page
 * @param {"x" | "y" | "z"} axis of the world
 * @param {number} by (m)
 */
export async function moveTarget(page, axis, by) {
  const target = [...(await state(page)).target.position];
  const i = "xyz".indexOf(axis);
  target[i] = (target[i] ?? 0) + by;
  await enter(page.locator(`[data-target="${axis}"]`), target[i]);
  await untilNear(page, "state.target.position", target, 1e-6);
  return target;
}

/**
 * Turns an overlay on, and waits for its first data.
 * @param {Page} page
 * @param {string} name
 */
export async function showOverlay(page, name) {
  await page.locator(`[data-overlay="${name}"]`).check();
  await until(page, `state.overlays["${name}"] !== undefined`);
}

/**
 * @param {Page} page
 * @param {string} name
 */
export async function openPanel(page, name) {
  const panel = page.locator(`[data-panel="${name}"]`);
  // By the keyboard: a click misses where a panel above gets its words while the pointer is on its way.
  if ((await panel.getAttribute("open")) === null) await panel.locator("summary").first().press("Enter");
  return panel;
}

/**
 * Largest difference of two lists of numbers.
 * @param {number[]} a
 * @param {number[]} b
 */
export function apart(a, b) {
  if (a.length !== b.length) return Infinity;
  return Math.max(0, ...a.map((value, i) => Math.abs(value - (b[i] ?? NaN))));
}

/**
 * Drags the target, or what else is at the handle, by the arrow that points along this way (or against it); gives where it was let go.
 * @param {Page} page
 * @param {[number, number, number]} way along an axis of the world (m)
 */
export async function drag(page, way) {
  // The camera's matrices are those of the last frame.
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const { from, to } = await page.evaluate((by) => {
    const { stage, target, project } = /** @type {any} */ (window).viewer;
    const box = stage.renderer.domElement.getBoundingClientRect();
    const place = target.gizmo.object.position;
    const far = stage.camera.position.distanceTo(place);
    const size = (far * Math.min(1.9 * Math.tan((Math.PI * stage.camera.fov) / 360), 7) * target.gizmo.size) / 4;
    const grip = by.map((part, i) => place.getComponent(i) + (part === 0 ? 0 : 0.45 * size));
    const pixel = (/** @type {number[]} */ point) => {
      const [x, y] = project(point);
      return { x: box.left + ((x + 1) / 2) * box.width, y: box.top + ((1 - y) / 2) * box.height };
    };
    return { from: pixel(grip), to: pixel(grip.map((part, i) => part + (by[i] ?? 0))) };
  }, way);
  await page.mouse.move(from.x, from.y);
  await page.waitForTimeout(300); // the arrow under the pointer is found when it rests
  await page.mouse.down();
  for (let i = 1; i <= 6; i += 1) await page.mouse.move(from.x + ((to.x - from.x) * i) / 6, from.y + ((to.y - from.y) * i) / 6);
  const place = await page.evaluate(() => /** @type {number[]} */ (/** @type {any} */ (window).viewer.target.gizmo.object.position.toArray()));
  await page.mouse.up();
  return place;
}

/**
 * What a button saves.
 * @param {Page} page
 * @param {string} name of the button
 * @param {BufferEncoding} encoding
 */
export async function saved(page, name, encoding = "utf8") {
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name }).click();
  return readFile(await (await coming).path(), encoding);
}

/**
 * Opens files by the dialogue.
 * @param {Page} page
 * @param {string[]} paths
 */
export async function openFiles(page, ...paths) {
  if (!(await page.locator("dialog").isVisible())) await page.getByRole("button", { name: "Open a file" }).click();
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Choose files" }).click()]);
  await chooser.setFiles(paths);
}

/**
 * Waits for the page of another model.
 * @param {Page} page
 * @param {string} name
 */
export async function untilModel(page, name) {
  await page.waitForFunction((wanted) => /** @type {any} */ (window).viewer?.session.scene?.name === wanted, name);
  await drawn(page);
}

/**
 * Shows a model beside the first, by the dialogue.
 * @param {Page} page
 * @param {string} name
 */
export async function addBeside(page, name) {
  await page.getByRole("button", { name: "Open a file" }).click();
  await page.getByRole("button", { name: `${name} beside the model that is shown` }).first().click();
  await page.locator("dialog").waitFor({ state: "hidden" });
}

/**
 * The models beside the first: their joints, places, and sizes along x.
 * @param {Page} page
 * @returns {Promise<{ name: string, q: number[], place: number[], size: number[] }[]>}
 */
export function beside(page) {
  return page.evaluate(() => [.../** @type {any} */ (window).viewer.companions.all.values()].map(({ session, group, robot }) => {
    const box = robot.box();
    return { name: session.scene?.name, q: session.state?.q, place: group.position.toArray(), size: [box.min.x, box.max.x] };
  }));
}

/**
 * Waits until these models stand beside the first, and its session has them.
 * @param {Page} page
 * @param {string[]} names
 */
export async function untilBeside(page, names) {
  await page.waitForFunction((wanted) => {
    const { session: first, companions } = /** @type {any} */ (window).viewer ?? {};
    const all = [...(companions?.all.values() ?? [])];
    const names = all.map(({ session, isPlaced }) => isPlaced && session.state !== null && session.scene.name);
    return first?.scene?.beside.length === all.length && JSON.stringify(names) === wanted;
  }, JSON.stringify(names));
}

/**
 * Waits until the first joint of a model beside the first has a value, as it is in its session.
 * @param {Page} page
 * @param {number} which
 * @param {number} value
 */
export async function untilBesideAt(page, which, value) {
  await page.waitForFunction(([i, wanted]) => {
    const all = [.../** @type {any} */ (window).viewer.companions.all.values()];
    return all[i ?? 0]?.session.state?.q[0] === wanted;
  }, [which, value]);
}
