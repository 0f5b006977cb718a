/** The page beside the robot: lost servers, the recorder, addresses, theme, keyboard. */
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { apart, launch, open, picture, serve, state, until } from "./lib.mjs";

/** @type {import("playwright-core").Browser} */
let browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

test("a stopped server is shown, and reconnected to with the configuration", async () => {
  const first = await serve("panda");
  const port = new URL(first.url).port;
  const { page, close } = await open(browser, first.url, { width: 1280, height: 720 });
  await page.getByLabel("panda_joint2 as a number").fill("-0.3");
  await page.keyboard.press("Enter");
  await until(page, "Math.abs(state.q[1] + 0.3) < 1e-9");
  await first.stop();
  await page.getByText("The server has stopped.").waitFor();
  await page.locator('.status[data-state="lost"]').waitFor();
  await picture(page, "server-stopped");
  const second = await serve("panda", "--port", port);
  try {
    await page.locator('.status[data-state="open"]').waitFor();
    await page.getByText("The server has stopped.").waitFor({ state: "hidden" });
    await until(page, "Math.abs(state.q[1] + 0.3) < 1e-6");
    await close();
  } finally {
    await second.stop();
  }
});

test("a page that draws slowly is sent no queue of old states", async () => {
  const server = await serve("panda");
  try {
    const { page, close } = await open(browser, server.url);
    await page.evaluate(() => {
      /** @type {any} */
      const { session, stage } = /** @type {any} */ (window).viewer;
      /** @type {{ drawn: number[], came: number }} */
      const counts = { drawn: [], came: 0 };
      Object.assign(window, { counts });
      session.on("raw", () => (counts.came += 1));
      session.on("state", (/** @type {any} */ state) => counts.drawn.push(state.seq));
      stage.onFrame(() => {
        const end = performance.now() + 200;
        while (performance.now() < end);
      });
    });
    const { position } = (await state(page)).target;
    await page.locator('[data-target="z"]').fill(String((position[2] ?? 0) - 0.25));
    await page.keyboard.press("Enter");
    await until(page, `state.servo.status === "reached" && state.target.position[2] < ${(position[2] ?? 0) - 0.2}`);
    const { drawn, came } = await page.evaluate(() => /** @type {any} */ (window).counts);
    assert.ok(came <= 2 * drawn.length + 2, `${came} states came, ${drawn.length} were drawn`);
    assert.ok(drawn.at(-1) - drawn[0] > 2 * drawn.length, "states between those drawn are left out");
    await close();
  } finally {
    await server.stop();
  }
});

test("the recorder gives every state as JSON and as CSV, and a PNG of the view", async () => {
  const server = await serve("panda");
  try {
    const { page, close } = await open(browser, server.url);
    await page.getByRole("button", { name: "Record" }).click();
    const wanted = ((await state(page)).target.position[0] ?? 0) + 0.05;
    await page.locator('[data-target="x"]').fill(String(wanted));
    await page.keyboard.press("Enter");
    // The state before the target came is one of rest too.
    await until(page, `state.servo.status === "reached" && Math.abs(state.tool.position[0] - ${wanted}) < 1e-3`);
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const json = JSON.parse(await saved(page, "Save the record as JSON"));
    assert.equal(json.joint_names.length, 7);
    assert.ok(json.states.length > 5);
    assert.ok(json.states.every((/** @type {any} */ s, /** @type {number} */ i) => i === 0 || s.seq > json.states[i - 1].seq));
    const lines = (await saved(page, "Save the record as CSV")).trim().split("\r\n");
    assert.equal(lines.length, json.states.length + 1);
    assert.equal(lines[0]?.split(",")[1], json.joint_names[0]);
    assert.equal(Number(lines[1]?.split(",")[0]), json.states[0].time);
    const picture = await saved(page, "Save a picture", "latin1");
    assert.equal(picture.slice(1, 4), "PNG");
    await close();
  } finally {
    await server.stop();
  }
});

/**
 * What a button saves.
 * @param {import("playwright-core").Page} page
 * @param {string} name
 * @param {BufferEncoding} encoding
 */
async function saved(page, name, encoding = "utf8") {
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name }).click();
  return readFile(await (await coming).path(), encoding);
}

test("an address carries the configuration, overlays and camera; a foreign one is refused in words", async () => {
  const server = await serve("panda");
  try {
    const { page, close } = await open(browser, server.url);
    await page.getByLabel("panda_joint6 as a number").fill("2.1");
    await page.keyboard.press("Enter");
    await until(page, "Math.abs(state.q[5] - 2.1) < 1e-9");
    await page.locator('[data-overlay="joint-axes"]').check();
    await page.getByRole("button", { name: "top" }).click();
    await page.getByRole("button", { name: /Copy an address/ }).click();
    await page.waitForFunction(() => location.hash.includes("q="));
    const address = page.url();
    const here = await state(page);
    const camera = await eye(page);
    await close();

    const again = await open(browser, address);
    await until(again.page, "Math.abs(state.q[5] - 2.1) < 1e-6");
    await until(again.page, 'state.overlays["joint-axes"] !== undefined');
    assert.ok(apart((await state(again.page)).q, here.q) < 1e-6);
    assert.ok(apart(await eye(again.page), camera) < 1e-6);
    assert.deepEqual(again.troubles, []);
    await again.close();

    const foreign = await open(browser, `${server.url}#model=ur5e&q=0,0,0,0,0,0`);
    await foreign.page.getByText("The address is for ur5e").waitFor();
    await foreign.close();
    const broken = await open(browser, `${server.url}#q=one,two`);
    await broken.page.getByText("no configuration that can be read").waitFor();
    assert.deepEqual(broken.troubles, []);
    await broken.close();
  } finally {
    await server.stop();
  }
});

/**
 * @param {import("playwright-core").Page} page
 * @returns {Promise<number[]>}
 */
function eye(page) {
  return page.evaluate(() => /** @type {any} */ (window).viewer.stage.camera.position.toArray());
}

test("a browser without WebGL is told what is missing", async () => {
  const server = await serve("panda");
  const bare = await launch("--disable-3d-apis");
  try {
    const page = await bare.newPage();
    await page.goto(server.url);
    await page.getByText("The view cannot be drawn.").waitFor();
  } finally {
    await bare.close();
    await server.stop();
  }
});

test("everything is reached by the keyboard and has a name; the theme is kept", async () => {
  const server = await serve("five-bar");
  try {
    const { page, close } = await open(browser, server.url);
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select")]
        .filter((element) => !element.getAttribute("aria-label") && !element.textContent?.trim() && !(/** @type {HTMLInputElement} */ (element).labels?.length))
        .map((element) => element.outerHTML.slice(0, 80)));
    assert.deepEqual(nameless, []);
    const reached = new Set();
    for (let i = 0; i < 60; i += 1) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => {
        const element = document.activeElement;
        return element?.getAttribute("data-drive") ?? element?.getAttribute("data-joint") ?? element?.getAttribute("data-overlay") ?? element?.tagName ?? "";
      }));
    }
    for (const name of ["q1", "q5", "velocity-ellipsoid", "cylindroid", "CANVAS", "SUMMARY", "SELECT"]) assert.ok(reached.has(name), `${name} is not reached by Tab: ${[...reached]}`);

    const theme = () => page.evaluate(() => document.documentElement.dataset["theme"]);
    assert.equal(await theme(), "light");
    await page.getByRole("button", { name: /^Theme/ }).click();
    await page.getByRole("button", { name: "Theme: light" }).click();
    assert.equal(await theme(), "dark");
    await page.reload();
    await page.waitForFunction(() => document.documentElement.dataset["theme"] === "dark");
    await close();
  } finally {
    await server.stop();
  }
});
