/** Every kind of model loads and is drawn, light and dark, without an error in the console. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { apart, browserOfFile, openPanel, picture, ROBOTS, served, showOverlay, state } from "./lib.mjs";

const { look, visit } = browserOfFile();

const BROKEN = fileURLToPath(new URL("robots/broken/broken.urdf", import.meta.url));
const COLLISIONS = fileURLToPath(new URL("robots/collisions/collisions.urdf", import.meta.url));
const SHAPES = fileURLToPath(new URL("robots/shapes/shapes.urdf", import.meta.url));

/** @type {{ name: string, args: string[], dark?: boolean, show: string[] }[]} */
const MODELS = [
  { name: "panda", args: ["panda"], show: ["velocity-ellipsoid", "joint-axes"] },
  { name: "xarm7-meshes", args: [`${ROBOTS}/xarm_description/urdf/xarm7.urdf`], dark: true, show: ["active-force-ellipsoid"] },
  { name: "five-bar", args: ["five-bar"], show: ["velocity-ellipsoid", "active-force-ellipsoid", "passive-force-ellipsoid"] },
  { name: "stewart", args: ["stewart"], dark: true, show: ["principal-screws", "angular-velocity-ellipsoid"] },
  { name: "two-arm", args: ["two-arm"], show: ["lost-direction"] },
  { name: "youbot-cylindroid", args: ["youbot", "--frame", "arm_link_2"], dark: true, show: ["cylindroid", "reciprocal-system"] },
];

for (const { name, args, dark = false, show } of MODELS) {
  test(`${name} loads and is drawn`, () =>
    visit(args, async (page) => {
      for (const overlay of show) await showOverlay(page, overlay);
      const seen = await state(page);
      assert.ok(seen.links.length > 1);
      assert.equal(await page.locator(".legend > div").count(), show.length);
      await page.waitForLoadState("networkidle");
      assert.deepEqual(await emptyView(page), false, "the view shows nothing");
      await picture(page, name);
    }, { dark, width: 1280, height: 720 }));
}

test("meshes of all three formats are shown; a missing one becomes rods and a sentence", () =>
  visit([SHAPES], async (page) => {
    await page.locator(".toast").waitFor();
    assert.match(await page.locator(".toast").innerText(), /not_there\.stl/);
    const links = await page.evaluate(() => {
      /** @type {any} */
      const robot = /** @type {any} */ (window).viewer.robot;
      return robot.links.map((/** @type {any} */ link) => ({ shapes: link.shapes.children.length, rods: link.skeleton.visible }));
    });
    assert.deepEqual(links.map((/** @type {any} */ link) => link.shapes).slice(0, 5), [1, 1, 1, 1, 0]);
    assert.deepEqual(links.map((/** @type {any} */ link) => link.rods).slice(0, 5), [false, false, false, false, true]);
    assert.ok((await sizes(page)).every((/** @type {number} */ height) => Math.abs(height - 0.4) < 1e-3), "all boxes are 0.4 m high, whatever their file's unit");
    await picture(page, "mesh-formats");
  }, { expect: /not_there|404/ }));

test("a mesh with vertices that are not finite is skipped, and the view stays", () =>
  visit([BROKEN], async (page) => {
    await page.locator(".toast").waitFor();
    assert.match(await page.locator(".toast").innerText(), /2 shapes are missing.*(nan|index)\.obj: it has vertices that are not finite/s);
    assert.deepEqual(await emptyView(page), false, "the view shows nothing");
  }));

test("collision shapes are shown, their meshes too; a missing one becomes a sentence", () =>
  visit([COLLISIONS], async (page) => {
    await page.getByRole("switch", { name: "Collision shapes" }).check();
    await page.locator(".toast").waitFor();
    assert.match(await page.locator(".toast").innerText(), /A collision shape is missing.*lost:.*not_there\.stl/s);
    const links = await page.evaluate(() => {
      /** @type {any} */
      const { collisions, stage } = /** @type {any} */ (window).viewer;
      stage.scene.updateMatrixWorld();
      return collisions.links.map((/** @type {any} */ link) => {
        /** @type {number[]} */
        const heights = [];
        link.traverse((/** @type {any} */ part) => {
          const places = part.geometry?.attributes.position;
          for (let i = 0; places && i < places.count; i += 1) heights.push(link.position.clone().fromBufferAttribute(places, i).applyMatrix4(part.matrixWorld).z);
        });
        return heights.length > 0 ? [Math.min(...heights), Math.max(...heights)] : [];
      });
    });
    assert.equal(links.length, 3);
    // The mesh is 0.4 m high, halved, and stands 0.1 m above its link, which is at 0.5 m.
    for (const [i, heights] of [[-0.05, 0.05], [0.6, 0.8], []].entries()) assert.ok(apart(links[i], heights) < 1e-6, `${links[i]}`);
    await picture(page, "collision-shapes");
  }));

test("at rest an open comparison asks no more", () =>
  visit(["ur5e"], async (page) => {
    const panel = await openPanel(page, "compare");
    await panel.locator("table").waitFor();
    await page.waitForTimeout(600);
    const asked = await page.evaluate(async () => {
      const { session } = /** @type {any} */ (window).viewer;
      const send = session.send.bind(session);
      let count = 0;
      session.send = (/** @type {any} */ message) => {
        count += message.type === "compare" ? 1 : 0;
        return send(message);
      };
      await new Promise((done) => setTimeout(done, 1500));
      session.send = send;
      return count;
    });
    assert.equal(asked, 0);
  }));

test("all panels and overlays of one arm fit together", () =>
  served(["panda"], async ({ url }) => {
    for (const dark of [false, true]) {
      await look(url, async (page) => {
        for (const panel of ["mobility", "capability", "compare"]) await openPanel(page, panel);
        await page.locator('[data-panel="compare"] table').waitFor();
        await page.locator('[data-panel="mobility"] dl').first().waitFor();
        for (const name of ["velocity-ellipsoid", "principal-screws"]) await showOverlay(page, name);
        const cut = await page.evaluate(() => [...document.querySelectorAll(".side *")].filter((element) => element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).overflowX === "visible" && element.clientWidth > 0).map((element) => `${element.tagName}.${element.className}`));
        assert.deepEqual(cut, [], "text runs out of its place");
        await picture(page, `panels-${dark ? "dark" : "light"}`);
      }, { dark, width: 1280, height: 1500 });
    }
  }));

/**
 * Whether the picture has one colour only.
 * @param {import("playwright-core").Page} page
 */
function emptyView(page) {
  return page.evaluate(async () => {
    const blob = await /** @type {any} */ (window).viewer.stage.png();
    const bitmap = await createImageBitmap(blob);
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    if (!context) return true;
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4 * 37) colours.add(((data[i] ?? 0) << 16) | ((data[i + 1] ?? 0) << 8) | (data[i + 2] ?? 0));
    return colours.size < 100;
  });
}

/**
 * Heights of the meshes of the test robot along its links.
 * @param {import("playwright-core").Page} page
 */
function sizes(page) {
  return page.evaluate(() => {
    /** @type {any} */
    const { robot } = /** @type {any} */ (window).viewer;
    return robot.links.slice(1, 4).map((/** @type {any} */ link) => {
      let [low, high] = [Infinity, -Infinity];
      const back = link.frame.matrixWorld.clone().invert();
      link.shapes.traverse((/** @type {any} */ part) => {
        const places = part.geometry?.attributes.position;
        for (let i = 0; places && i < places.count; i += 1) {
          const z = link.frame.position.clone().fromBufferAttribute(places, i).applyMatrix4(part.matrixWorld).applyMatrix4(back).z;
          [low, high] = [Math.min(low, z), Math.max(high, z)];
        }
      });
      return high - low;
    });
  });
}
