/** The robot as a file of binary glTF: names, places, meshes and their extent, y upwards. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { apart, browserOfFile, moveTarget, saved, state, untilReached } from "./lib.mjs";

const { visit } = browserOfFile();

const SHAPES = fileURLToPath(new URL("robots/shapes/shapes.urdf", import.meta.url));
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** @typedef {{ low: number[], high: number[], meshes: number }} Extent */

/**
 * What the page saves.
 * @param {import("playwright-core").Page} page
 */
async function file(page) {
  const all = Buffer.from(await saved(page, "glTF", "latin1"), "latin1");
  assert.equal(all.toString("latin1", 0, 4), "glTF");
  return JSON.parse(all.toString("utf8", 20, 20 + all.readUInt32LE(12)));
}

/**
 * Product of two matrices, column by column.
 * @param {number[]} a
 * @param {number[]} b
 */
function product(a, b) {
  return IDENTITY.map((_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + (a[(i % 4) + 4 * k] ?? 0) * (b[k + 4 * Math.floor(i / 4)] ?? 0), 0));
}

/**
 * The boxes of all meshes below a node, in the axes of the world: x, y and z upwards.
 * @param {any} gltf
 * @param {number} index of the node
 * @param {number[]} [above] world_from_parent
 * @param {Extent} [extent]
 */
function extentOf(gltf, index, above = IDENTITY, extent = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity], meshes: 0 }) {
  const node = gltf.nodes[index];
  assert.ok(!node.translation && !node.rotation && !node.scale, "the exporter writes matrices");
  const here = product(above, node.matrix ?? IDENTITY);
  if (node.mesh !== undefined) {
    extent.meshes += 1;
    for (const { attributes } of gltf.meshes[node.mesh].primitives) {
      const { min, max } = gltf.accessors[attributes.POSITION];
      for (let corner = 0; corner < 8; corner += 1) {
        const at = [0, 1, 2].map((i) => ((corner >> i) & 1 ? max[i] : min[i]));
        const [x = 0, y = 0, z = 0] = product(here, [...IDENTITY.slice(0, 12), ...at, 1]).slice(12, 15);
        [x, -z, y].forEach((part, i) => {
          extent.low[i] = Math.min(extent.low[i] ?? 0, part);
          extent.high[i] = Math.max(extent.high[i] ?? 0, part);
        });
      }
    }
  }
  for (const child of node.children ?? []) extentOf(gltf, child, here, extent);
  return extent;
}

/**
 * The same of a link of the file, with all above it.
 * @param {any} gltf
 * @param {string} name
 */
function extentOfLink(gltf, name) {
  const index = gltf.nodes.findIndex((/** @type {any} */ node) => node.name === name);
  /** @type {number[]} */
  let above = IDENTITY;
  for (let at = index; ; ) {
    const parent = gltf.nodes.findIndex((/** @type {any} */ node) => node.children?.includes(at));
    if (parent < 0) break;
    above = product(gltf.nodes[parent].matrix ?? IDENTITY, above);
    at = parent;
  }
  return extentOf(gltf, index, above);
}

/**
 * What the page draws.
 * @param {import("playwright-core").Page} page
 * @returns {Promise<Extent>}
 */
function drawn(page) {
  return page.evaluate(() => {
    const { group } = /** @type {any} */ (window).viewer.robot;
    group.updateMatrixWorld(true);
    /** @type {any} */
    let box = null;
    let meshes = 0;
    group.traverseVisible((/** @type {any} */ part) => {
      if (!part.isMesh) return;
      part.geometry.computeBoundingBox();
      const own = part.geometry.boundingBox.clone().applyMatrix4(part.matrixWorld);
      box = box ? box.union(own) : own;
      meshes += 1;
    });
    return { low: box.min.toArray(), high: box.max.toArray(), meshes };
  });
}

test("the robot is saved as glTF as it is drawn, y upwards", () =>
  visit(["panda"], async (page) => {
    await untilReached(page, await moveTarget(page, "z", -0.05));
    const { nodes, scenes } = await file(page);
    const root = nodes[scenes[0].nodes[0]];
    assert.equal(root.name, "panda");
    assert.ok(apart(root.matrix.slice(0, 12), [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0]) < 1e-6);
    const links = await page.evaluate(() => /** @type {any} */ (window).viewer.robot.links.map((/** @type {any} */ { frame }) => [frame.name, frame.position.toArray()]));
    for (const [name, position] of links) {
      const node = nodes.find((/** @type {any} */ one) => one.name === name);
      assert.ok(apart(node.translation ?? node.matrix?.slice(12, 15) ?? [0, 0, 0], position) < 1e-6, name);
    }
  }));

test("shapes of the model are saved where they are, those that are missing as rods", () =>
  visit([SHAPES], async (page) => {
    await page.locator(".toast").waitFor();
    const [gltf, seen] = [await file(page), await drawn(page)];
    const all = extentOf(gltf, gltf.scenes[0].nodes[0]);
    assert.equal(all.meshes, seen.meshes);
    assert.ok(apart(all.low, seen.low) < 1e-6 && apart(all.high, seen.high) < 1e-6, JSON.stringify({ all, seen }));
    // A cylinder, and three boxes of 0.12 x 0.12 x 0.4 m one on the other.
    const cylinder = extentOfLink(gltf, "base");
    assert.ok(apart(cylinder.low, [-0.12, -0.12, 0]) < 1e-3 && apart(cylinder.high, [0.12, 0.12, 0.1]) < 1e-3, JSON.stringify(cylinder));
    for (const [i, name] of ["stl", "dae", "obj"].entries()) {
      const { low, high, meshes } = extentOfLink(gltf, name);
      const bottom = 0.1 + 0.4 * i;
      assert.ok(meshes > 0 && apart(low, [-0.06, -0.06, bottom]) < 1e-6 && apart(high, [0.06, 0.06, bottom + 0.4]) < 1e-6, `${name}: ${low} to ${high}`);
    }
    assert.ok(extentOfLink(gltf, "lost").meshes > 0, "rods");
  }, { expect: /not_there|404/ }));

test("a closed chain is saved with its loop joints", () =>
  visit(["five-bar"], async (page) => {
    const [gltf, seen, { links, loops }] = [await file(page), await drawn(page), await state(page)];
    const all = extentOf(gltf, gltf.scenes[0].nodes[0]);
    assert.equal(all.meshes, seen.meshes);
    assert.ok(all.meshes > links.length && apart(all.low, seen.low) < 1e-6 && apart(all.high, seen.high) < 1e-6, JSON.stringify({ all, seen }));
    for (const { a } of loops) {
      const isThere = (/** @type {any} */ node) => node.matrix && apart(node.matrix.slice(12, 15), a) < 1e-6;
      assert.ok(gltf.nodes.some(isThere), `the loop joint at ${a}`);
    }
  }));
