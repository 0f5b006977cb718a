/** The file of the model changes while it is shown: the new version comes with the view and the joints as they were. */
import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { apart, browserOfFile, enter, openPanel, picture, scene, showOverlay, state, until } from "./lib.mjs";

const { visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-reload-"));

const LIMIT = '<limit lower="-2" upper="2" velocity="1" effort="1"/>';
/** @param {{ length?: number, name?: string, elbow?: string, mesh?: boolean }} version */
const arm = ({ length = 0.5, name = "crane", elbow = "elbow", mesh = false } = {}) => `<robot name="${name}">
  <link name="base"/>
  <link name="upper">${mesh ? '<visual><geometry><mesh filename="a.stl"/></geometry></visual>' : ""}</link>
  <link name="lower"/>
  <link name="hand"/>
  <joint name="lift" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>${LIMIT}</joint>
  <joint name="${elbow}" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 ${length}"/><axis xyz="0 1 0"/>${LIMIT}</joint>
  <joint name="end" type="fixed"><parent link="lower"/><child link="hand"/><origin xyz="0 0 0.4"/></joint>
</robot>
`;
/** @param {number} size */
const mesh = (size) => `solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex ${size} 0 0\nvertex 0 ${size} 0\nendloop\nendfacet\nendsolid a\n`;

/** @param {import("playwright-core").Page} page */
const eye = (page) => page.evaluate(() => {
  const { camera, orbit } = /** @type {any} */ (window).viewer.stage;
  return [...camera.position.toArray(), ...orbit.target.toArray()];
});

/** @param {import("playwright-core").Page} page */
const elbow = async (page) => (await scene(page)).joints[1]?.origin.position[2];

for (const [width, height, dark] of /** @type {const} */ ([[1366, 768, false], [390, 844, true]])) {
  test(`a changed file is shown with view, joints, overlays and selection as they were, ${width} x ${height}`, async () => {
    const path = join(folder, `crane-${width}.urdf`);
    await writeFile(path, arm());
    await visit([path], async (page) => {
      await enter(page.getByLabel("lift as a number"), 0.5);
      await enter(page.getByLabel("elbow as a number"), -0.75);
      await until(page, "state.q[0] === 0.5 && state.q[1] === -0.75");
      await showOverlay(page, "joint-axes");
      await page.locator("canvas").focus();
      await page.keyboard.press("Shift+ArrowRight");
      await page.keyboard.press("+");
      await page.evaluate(() => /** @type {any} */ (window).viewer.selection.select("link lower"));
      const before = await eye(page);
      await writeFile(path, arm({ length: 0.7 }));
      await page.getByText("its new version is shown").waitFor();
      await until(page, "scene.joints[1].origin.position[2] === 0.7");
      await until(page, 'state.overlays["joint-axes"] !== undefined');
      assert.deepEqual((await state(page)).q, [0.5, -0.75]);
      assert.ok(apart(await eye(page), before) < 1e-9, "the view stays");
      assert.equal(await page.getByLabel("elbow as a number").inputValue(), "-0.7500");
      const selected = await page.evaluate(() => /** @type {any} */ (window).viewer.selection.selected?.name);
      assert.equal(selected, "lower");
      // Rods are those of the new version, as soon as it is drawn.
      await page.waitForFunction(() => {
        const { robot } = /** @type {any} */ (window).viewer;
        const drawn = robot.linkFrame(2).position.distanceTo(robot.linkFrame(1).position);
        return Math.abs(drawn - 0.7) < 1e-6;
      });
      await picture(page, `reload-${width}-${dark ? "dark" : "light"}`);
      // Another name of the model and of a joint: the view stays, and the joint begins anew.
      await writeFile(path, arm({ length: 0.7, name: "hoist", elbow: "knee" }));
      await until(page, 'scene.name === "hoist"');
      await until(page, "state.q[0] === 0.5 && state.q[1] === 0");
      assert.ok(apart(await eye(page), before) < 1e-9);
      assert.match(await page.title(), /^hoist/);
    }, { width, height, dark });
  });

  test(`a broken file is told with its line beside the version before it, ${width} x ${height}`, async () => {
    const path = join(folder, `broken-${width}.urdf`);
    await writeFile(path, arm());
    await visit([path], async (page) => {
      await enter(page.getByLabel("lift as a number"), 0.5);
      await until(page, "state.q[0] === 0.5");
      await writeFile(path, arm().replace('child link="lower"', 'child link="lover"'));
      const alert = page.getByRole("alert").filter({ hasText: "has a fault" });
      await alert.waitFor();
      const words = await alert.textContent();
      assert.match(words ?? "", new RegExp(`broken-${width}\\.urdf, line 7, column \\d+`));
      assert.match(words ?? "", /lover/);
      await picture(page, `reload-broken-${width}-${dark ? "dark" : "light"}`);
      const box = await alert.boundingBox();
      assert.ok(box && box.x >= 0 && box.x + box.width <= width, JSON.stringify(box));
      // The old model goes on.
      await enter(page.getByLabel("elbow as a number"), 1);
      await until(page, "state.q[1] === 1");
      await alert.getByRole("button", { name: "Close" }).click();
      await alert.waitFor({ state: "hidden" });
      await writeFile(path, arm().replace("</robot>", ""));
      await alert.waitFor();
      await writeFile(path, arm({ length: 0.6 }));
      await alert.waitFor({ state: "hidden" });
      await until(page, "scene.joints[1].origin.position[2] === 0.6 && state.q[0] === 0.5 && state.q[1] === 1");
      assert.equal(await elbow(page), 0.6);
    }, { width, height, dark });
  });
}

test("a changed mesh is drawn anew", async () => {
  const path = join(folder, "mesh.urdf");
  await writeFile(path, arm({ mesh: true }));
  await writeFile(join(folder, "a.stl"), mesh(0.25));
  await visit([path], async (page) => {
    const size = () => page.evaluate(() => {
      let largest = 0;
      /** @type {any} */ (window).viewer.robot.links[1].shapes.traverse((/** @type {any} */ part) => {
        for (const x of part.geometry?.getAttribute("position").array ?? []) largest = Math.max(largest, x);
      });
      return largest;
    });
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    assert.equal(await size(), 0.25);
    await writeFile(join(folder, "a.stl"), mesh(0.5));
    await page.getByText("its new version is shown").waitFor();
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    assert.equal(await size(), 0.5);
  });
});

test("who comes later, or comes back, is told of no change that is already there", async () => {
  const path = join(folder, "later.urdf");
  await writeFile(path, arm());
  await visit([path], async (page, server) => {
    await writeFile(path, arm({ length: 0.7 }));
    await page.getByText("its new version is shown").waitFor();
    const other = await page.context().newPage();
    await other.goto(server.url);
    await other.waitForFunction(() => /** @type {any} */ (window).viewer?.session.scene?.joints[1].origin.position[2] === 0.7);
    await other.waitForTimeout(300);
    assert.equal(await other.getByText("its new version is shown").count(), 0);
    await openPanel(page, "model");
    await page.locator('[data-item="joint elbow"]').waitFor();
  });
});
