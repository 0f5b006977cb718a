/** Recordings that leave the page: one HTML file that plays without a server, and numbered pictures. */
import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { unzipSync } from "three/addons/libs/fflate.module.js";
import { apart, browserOfFile, enter, launch, moveTarget, PATIENCE, picture, ROBOTS, saved, showOverlay, state, until, untilReached } from "./lib.mjs";

/** @typedef {import("playwright-core").Page} Page */

const { visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-film-"));
const SHAPES = fileURLToPath(new URL("robots/shapes/shapes.urdf", import.meta.url));

/**
 * Records while the tool goes along an axis.
 * @param {Page} page
 * @param {"x" | "y" | "z"} axis
 * @param {number} by (m)
 */
async function record(page, axis, by) {
  await page.getByRole("button", { name: "Record" }).click();
  await untilReached(page, await moveTarget(page, axis, by));
  await page.getByRole("button", { name: /^Stop recording/ }).click();
}

/**
 * Saves the page that plays the recording, and opens it from its file in a browser that reaches no server.
 * @param {Page} page
 * @param {string} name
 * @param {(film: Page, html: string) => Promise<void>} work
 */
async function film(page, name, work) {
  const html = await saved(page, "Save HTML that plays the recording by itself");
  const path = join(folder, `${name}.html`);
  await writeFile(path, html);
  const browser = await launch();
  try {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, offline: true });
    const film = await context.newPage();
    film.setDefaultTimeout(PATIENCE);
    /** @type {string[]} */
    const troubles = [];
    film.on("console", (message) => message.type() === "error" && troubles.push(message.text()));
    film.on("pageerror", (error) => troubles.push(String(error)));
    film.on("request", (request) => {
      if (!/^(file|blob|data):/.test(request.url())) troubles.push(`asked for ${request.url()}`);
    });
    await film.goto(pathToFileURL(path).href);
    await film.waitForFunction(() => /** @type {any} */ (window).film?.stage.frames > 1);
    await work(film, html);
    assert.deepEqual(troubles, []);
  } finally {
    await browser.close();
  }
}

/**
 * Places of all links as they are drawn.
 * @param {Page} page
 * @param {string} from "viewer" or "film"
 * @returns {Promise<number[]>}
 */
const places = (page, from) => page.evaluate((name) => /** @type {any} */ (window)[name].robot.links.flatMap((/** @type {any} */ { frame }) => [...frame.position.toArray(), ...frame.quaternion.toArray()]), from);

/**
 * The number of the state that is shown.
 * @param {Page} page
 */
const shown = (page) => page.evaluate(() => /** @type {any} */ (window).film.state().seq);

test("a recording is one HTML file that plays from its file, without a server", () =>
  visit(["panda", "--obstacle", "ball=sphere:0.08@0.5,0.4,0.6"], async (page, server) => {
    await showOverlay(page, "velocity-ellipsoid");
    await record(page, "z", -0.15);
    const { states, times } = JSON.parse(await saved(page, "Save the recording as JSON"));
    await film(page, "panda", async (film, html) => {
      // The port alone may be among the digits of the states.
      assert.ok(!html.includes(new URL(server.url).host), "no address of the server is in it");
      assert.equal(await film.evaluate(() => /** @type {any} */ (window).film.recording.length), states.length);
      await film.getByText(`${states.length} states`).waitFor();
      assert.equal(await shown(film), states[0].seq);
      // Scrubbed to the end: the robot is where it was, and so are the numbers beside it.
      const slider = film.getByLabel("Time of the recording [s]");
      await slider.focus();
      await film.keyboard.press("End");
      await film.waitForFunction((seq) => /** @type {any} */ (window).film.state().seq === seq, states.at(-1).seq);
      const last = states.at(-1).links.flatMap((/** @type {any} */ { position, quaternion: [w, x, y, z] }) => [...position, x, y, z, w]);
      assert.ok(apart(await places(film, "film"), last) < 1e-12);
      const x = film.locator('[data-panel="pose"] [data-pose="x"]');
      assert.equal(await x.getAttribute("data-value"), String(states.at(-1).tool.position[0]));
      await film.locator(".legend").getByText("Velocity ellipsoid").waitFor();
      await film.locator('[data-plot="joints"] canvas').waitFor();
      await picture(film, "film");
      // Played from the beginning, slowly: it does not end before it is paused. The slider may have rounded its end.
      await film.evaluate(() => /** @type {any} */ (window).film.player.seek(/** @type {any} */ (window).film.recording.duration - 1e-12));
      await film.getByLabel("Speed of playing back").selectOption({ index: 0 });
      await film.getByRole("button", { name: "Play back" }).click();
      await film.waitForFunction(() => /** @type {any} */ (window).film.player.time > 0.01 && /** @type {any} */ (window).film.player.playing);
      await film.getByRole("button", { name: "Pause playback" }).click();
      assert.ok((await shown(film)) < states.at(-1).seq);
      await film.keyboard.press("Home");
      assert.ok(times.at(-1) > 0.2);
    });
  }));

test("meshes of all formats are in the file; a missing one is drawn as rods there too", () =>
  visit([SHAPES], async (page) => {
    await page.getByLabel("Task", { exact: true }).selectOption("position");
    await page.getByRole("button", { name: "Record" }).click();
    await enter(page.getByLabel("joint1 as a number"), 0.4);
    await until(page, "Math.abs(state.q[0] - 0.4) < 1e-9");
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    const shapes = (/** @type {Page} */ of, /** @type {string} */ from) => of.evaluate((name) => /** @type {any} */ (window)[name].robot.links.map((/** @type {any} */ { shapes, skeleton }) => {
      let [corners, red] = [0, 0];
      shapes.traverse((/** @type {any} */ part) => {
        if (!part.isMesh) return;
        part.geometry.computeBoundingBox();
        const size = part.geometry.boundingBox.getSize(part.position.clone());
        corners += size.length();
        red += (Array.isArray(part.material) ? part.material[0] : part.material).color.r;
      });
      return { shapes: shapes.children.length, rods: skeleton.visible, corners, red };
    }), from);
    const here = await shapes(page, "viewer");
    await film(page, "shapes", async (film) => {
      await film.waitForFunction(() => /** @type {any} */ (window).film.robot.links[3].shapes.children.length > 0);
      const there = await shapes(film, "film");
      assert.deepEqual(there.map((/** @type {any} */ one) => [one.shapes, one.rods]), here.map((/** @type {any} */ one) => [one.shapes, one.rods]));
      for (const part of ["corners", "red"]) assert.ok(apart(there.map((/** @type {any} */ one) => one[part]), here.map((/** @type {any} */ one) => one[part])) < 1e-4, `${part}: ${JSON.stringify([here, there])}`);
      await picture(film, "film-meshes");
    });
  }, { expect: /not_there|404/ }));

test("the file of a robot with many meshes", (t) =>
  visit([`${ROBOTS}/xarm_description/urdf/xarm7.urdf`], async (page) => {
    await page.waitForLoadState("networkidle");
    await record(page, "z", -0.1);
    await film(page, "xarm7", async (film, html) => {
      t.diagnostic(`${(html.length / 1e6).toFixed(1)} MB`);
      assert.ok(html.length < 40e6);
      await film.waitForFunction(() => /** @type {any} */ (window).film.robot.links.filter((/** @type {any} */ { shapes }) => shapes.children.length > 0).length > 7);
      await picture(film, "film-xarm7");
    });
  }));

test("pictures at even times are a zip of numbered PNG", () =>
  visit(["panda"], async (page) => {
    await record(page, "y", 0.2);
    await page.locator('[data-overlay="joint-axes"]').check();
    await until(page, 'state.overlays["joint-axes"] !== undefined');
    const before = await state(page);
    const { times } = JSON.parse(await saved(page, "Save the recording as JSON"));
    await enter(page.getByLabel("Frames per second"), 10);
    const zip = await saved(page, "Save frames as a zip of numbered PNG", "latin1");
    const files = unzipSync(Buffer.from(zip, "latin1"));
    const names = Object.keys(files);
    assert.equal(names.length, Math.floor(times.at(-1) * 10 + 1e-6) + 1);
    assert.equal(names[0], `panda-${"1".padStart(String(names.length).length, "0")}.png`);
    const size = await page.evaluate(() => {
      const { width, height } = /** @type {any} */ (window).viewer.stage.renderer.domElement;
      return [width, height];
    });
    const seen = await page.evaluate(async (pictures) => {
      const all = [];
      for (const text of pictures) {
        const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))]));
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        context?.drawImage(bitmap, 0, 0);
        all.push({ size: [bitmap.width, bitmap.height], data: context?.getImageData(0, 0, bitmap.width, bitmap.height).data ?? [] });
      }
      const first = all[0]?.data ?? [];
      return all.map(({ size, data }) => ({ size, changed: [...data].filter((value, i) => Math.abs(value - (first[i] ?? 0)) > 40).length }));
    }, names.map((name) => Buffer.from(files[name] ?? []).toString("base64")));
    for (const one of seen) assert.deepEqual(one.size, size);
    assert.ok((seen.at(-1)?.changed ?? 0) > 1000, "the robot moves through the pictures");
    // The session has not moved, and a rate that cannot be is refused.
    assert.ok(apart((await state(page)).q, before.q) < 1e-4);
    await enter(page.getByLabel("Frames per second"), 0);
    await page.getByRole("button", { name: "Save frames as a zip of numbered PNG" }).click();
    await page.getByText("Frames per second are a number from 1 to 120.").waitFor();
  }));

test("a video of the recording has the size of the view, and moves", (t) =>
  visit(["panda"], async (page) => {
    await record(page, "y", 0.2);
    const before = await state(page);
    const { times } = JSON.parse(await saved(page, "Save the recording as JSON"));
    await enter(page.getByLabel("Frames per second"), 10);
    const name = await page.getByRole("button", { name: /^Save a video/ }).getAttribute("aria-label");
    assert.equal(name, "Save a video (WebM)");
    const bytes = await saved(page, name, "base64");
    const size = await page.evaluate(() => {
      const { width, height } = /** @type {any} */ (window).viewer.stage.renderer.domElement;
      return [width - (width % 2), height - (height % 2)];
    });
    assert.ok(apart((await state(page)).q, before.q) < 1e-4, "the session has not moved");
    // Played elsewhere: the page's policy has no place for videos.
    const player = await page.context().newPage();
    const seen = await player.evaluate(async (text) => {
      const video = document.createElement("video");
      video.muted = true;
      video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], { type: "video/webm" }));
      const next = (/** @type {string} */ event) => new Promise((resolve, reject) => {
        video.addEventListener(event, resolve, { once: true });
        video.addEventListener("error", () => reject(new Error(video.error?.message)), { once: true });
      });
      await next("loadeddata");
      const picture = () => {
        const context = new OffscreenCanvas(video.videoWidth, video.videoHeight).getContext("2d");
        context?.drawImage(video, 0, 0);
        return context?.getImageData(0, 0, video.videoWidth, video.videoHeight).data ?? [];
      };
      const first = picture();
      video.currentTime = 1e9;
      await next("seeked");
      const last = picture();
      return { size: [video.videoWidth, video.videoHeight], seconds: video.duration, changed: [...last].filter((value, i) => Math.abs(value - (first[i] ?? 0)) > 40).length };
    }, bytes);
    assert.deepEqual(seen.size, size);
    assert.ok(seen.changed > 1000, "the robot moves through the video");
    assert.ok(Math.abs(seen.seconds - times.at(-1)) < 2e-3, `${seen.seconds} s of video, ${times.at(-1)} s of recording`);
    t.diagnostic(`${seen.seconds.toFixed(1)} s, ${(bytes.length * 0.75 / 1e6).toFixed(1)} MB`);
    // A second press ends it, without a file.
    await page.getByRole("button", { name }).click();
    await page.getByRole("button", { name }).getByText(/ of /).waitFor();
    await page.getByRole("button", { name }).click();
    await page.getByText("No video saved").waitFor();
  }));
