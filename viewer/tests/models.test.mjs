/** Models that the page opens: files, zips, the catalogue; what is wrong with them is said with its place. */
import assert from "node:assert/strict";
import { mkdir, mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { strToU8, zipSync } from "three/addons/libs/fflate.module.js";
import { browserOfFile, openFiles, picture, state, until, untilModel } from "./lib.mjs";

const { visit, look } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-models-"));

const JOINT = '<joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>';
/** @param {string} mesh */
const urdf = (mesh) => `<robot name="crane">
  <link name="base"/>
  <link name="arm"><visual><geometry><mesh filename="${mesh}"/></geometry></visual></link>
  ${JOINT}
</robot>
`;
const MESH = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

/**
 * A zip of these texts.
 * @param {string} name
 * @param {Record<string, string>} texts
 */
async function zip(name, texts) {
  const path = join(folder, name);
  await writeFile(path, zipSync(Object.fromEntries(Object.entries(texts).map(([inside, text]) => [inside, strToU8(text)]))));
  return path;
}

/**
 * @param {string} name
 * @param {string} text
 */
async function file(name, text) {
  const path = join(folder, name);
  await writeFile(path, text);
  return path;
}

test("a zip with a URDF and its package is opened with its meshes, and the page leads back to it", () =>
  visit(["panda"], async (page, server) => {
    const path = await zip("crane.zip", {
      "crane/package.xml": "<package><name>crane</name></package>", "crane/urdf/crane.urdf": urdf("package://crane/meshes/a.stl"),
      "crane/meshes/a.stl": MESH, "crane/readme.md": "left out", "__MACOSX/crane/urdf/._crane.urdf": "left out",
    });
    await openFiles(page, path);
    await untilModel(page, "crane");
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    assert.deepEqual((await state(page)).q, [0]);
    assert.match(page.url(), /\?model=[0-9a-f]{16}$/);
    await page.getByLabel("lift as a number").fill("0.5");
    await page.getByLabel("lift as a number").press("Enter");
    await until(page, "Math.abs(state.q[0] - 0.5) < 1e-9");
    await look(page.url(), async (other) => {
      await untilModel(other, "crane");
      await other.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    });
    await look(server.url, (other) => untilModel(other, "panda"));
  }));

test("a URDF and its mesh are chosen together; of two models one is chosen; a drop opens as well", () =>
  visit(["panda"], async (page) => {
    await openFiles(page, await file("b.urdf", urdf("b.stl")), await file("b.stl", MESH));
    await untilModel(page, "crane");
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    await openFiles(page, await zip("two.zip", { "one.urdf": urdf("x.stl").replace("crane", "first"), "two.urdf": urdf("x.stl").replace("crane", "second") }));
    await page.getByRole("button", { name: "two.urdf" }).click();
    await untilModel(page, "second");
    await page.getByText(/A shape is missing and drawn as rods/).waitFor();
    const transfer = await page.evaluateHandle((text) => {
      const data = new DataTransfer();
      data.items.add(new File([text], "dropped.urdf"));
      return data;
    }, urdf("x.stl").replace("crane", "third"));
    for (const type of ["dragover", "drop"]) await page.dispatchEvent("canvas", type, { dataTransfer: transfer });
    await untilModel(page, "third");
  }));

/**
 * Drops a file or a folder of the disk on the view.
 * @param {import("playwright-core").Page} page
 * @param {string} path
 */
async function drop(page, path) {
  const devtools = await page.context().newCDPSession(page);
  for (const type of /** @type {const} */ (["dragEnter", "dragOver", "drop"])) {
    await devtools.send("Input.dispatchDragEvent", { type, x: 400, y: 300, data: { items: [], files: [path], dragOperationsMask: 1 } });
  }
}

test("a folder is dropped with a package in it: URDF, xacro, meshes, and what is hidden", () =>
  visit(["panda"], async (page, server) => {
    const root = join(folder, "workspace");
    for (const [path, text] of /** @type {const} */ ([
      ["crane/package.xml", "<package><name>crane</name></package>"], ["crane/urdf/crane.urdf", urdf("package://crane/meshes/a.stl")],
      ["crane/urdf/crane.xacro", "<robot/>"], ["crane/meshes/a.stl", MESH], ["crane/readme.md", "left out"], ["crane/poses.csv", "lift\n0\n"],
      ["crane/.git/b.urdf", urdf("b.stl")],
      // Readers of folders give a hundred entries at a time.
      ...Array.from({ length: 120 }, (_, i) => /** @type {const} */ ([`crane/textures/${i}.png`, ""])),
    ])) {
      await mkdir(join(root, path, ".."), { recursive: true });
      await writeFile(join(root, path), text);
    }
    await drop(page, root);
    await untilModel(page, "crane");
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
    const sent = await (await fetch(`${server.url}models/${new URL(page.url()).searchParams.get("model")}`)).text();
    const { open, files } = JSON.parse(sent.split("\n")[0] ?? "");
    assert.equal(open, "workspace/crane/urdf/crane.urdf");
    assert.equal(files.length, 3 + 120);
    // A folder without a model says so; a file of the disk opens as well.
    const empty = join(folder, "empty");
    await mkdir(empty);
    for (let i = 0; i < 8; i += 1) await writeFile(join(empty, `${i}.md`), "");
    await drop(page, empty);
    await page.locator("dialog .problem").getByText(/empty\/\d\.md, .*, 3 more: no URDF/).waitFor();
    await page.keyboard.press("Escape");
    await drop(page, await file("single.urdf", urdf("a.stl").replace("crane", "single")));
    await untilModel(page, "single");
  }));

const MJCF = '<mujoco model="swing"><worldbody><body name="arm"><joint name="lift" type="hinge" axis="0 1 0"/><geom size="0.1"/></body></worldbody></mujoco>';
const SDF = '<sdf version="1.9"><model name="gate"><link name="a"/><link name="b"/><joint name="lift" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>';
const TOML = 'name = "slide"\n[[joint]]\nname = "lift"\ntype = "prismatic"\nbetween = ["ground", "cart"]\norigin = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true\n';

test("MJCF, SDF and mechanism files open by a drop, alone and in a zip", () =>
  visit(["panda"], async (page) => {
    for (const [name, model, text] of /** @type {const} */ ([["swing.xml", "swing", MJCF], ["gate.sdf", "gate", SDF], ["slide.toml", "slide", TOML]])) {
      for (const zipped of [false, true]) {
        const called = zipped ? `${model}-2` : model;
        const changed = text.replace(`"${model}"`, `"${called}"`);
        const bytes = zipped ? zipSync({ [name]: strToU8(changed) }) : strToU8(changed);
        const transfer = await page.evaluateHandle(([numbers, file]) => {
          const data = new DataTransfer();
          data.items.add(new File([new Uint8Array(numbers)], file));
          return data;
        }, /** @type {const} */ ([[...bytes], zipped ? `${model}.zip` : name]));
        for (const type of ["dragover", "drop"]) await page.dispatchEvent("canvas", type, { dataTransfer: transfer });
        await untilModel(page, called);
        await page.getByLabel("lift as a number").fill("0.25");
        await page.getByLabel("lift as a number").press("Enter");
        await until(page, "Math.abs(state.q[0] - 0.25) < 1e-9");
      }
    }
  }));

test("what is wrong with a file is said with file, line and text, and the model stays", () =>
  visit(["panda"], async (page) => {
    const problem = page.locator("dialog .problem");
    for (const [path, told] of /** @type {const} */ ([
      [await file("tag.urdf", urdf("a.stl").replace("</robot>", "")), /tag\.urdf, line \d+, column \d+/],
      [await file("name.urdf", urdf("a.stl").replace('link="arm"/><axis', 'link="leg"/><axis')), /name\.urdf, line 4, column \d+.*leg/],
      [await file("key.toml", '[[joint]]\nname = "a"\ntyp = "revolute"\n'), /key\.toml, line 3, column \d+.*typ/],
      [await file("plain.xml", "<html/>"), /plain\.xml: no URDF, MJCF, SDF or mechanism file/],
      [await file("robot.xacro", "<robot/>"), /expand it first/],
      [await file("not.zip", "no zip"), /not\.zip cannot be unpacked/],
      [await zip("bad.zip", { "deep/bad.sdf": "<sdf version='1.7'><model name='a'><joint/></model></sdf>" }), /deep\/bad\.sdf, line 1, column \d+/],
    ])) {
      await openFiles(page, path);
      await problem.getByText(/./).first().waitFor();
      await page.waitForFunction((pattern) => new RegExp(pattern, "s").test(document.querySelector("dialog .problem")?.textContent ?? ""), told.source);
    }
    await picture(page, "open-refused");
    await page.keyboard.press("Escape");
    await page.locator("dialog").waitFor({ state: "hidden" });
    assert.equal((await page.evaluate(() => /** @type {any} */ (window).viewer.session.scene)).name, "panda");
  }, { expect: /422/ }));

test("models of the catalogue are switched by the keyboard; an address of a model that is gone says so", () =>
  visit(["panda"], async (page, server) => {
    await page.getByRole("button", { name: "Open a file" }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "five-bar", exact: true }).focus();
    await picture(page, "open-dialogue");
    await page.keyboard.press("Enter");
    await untilModel(page, "five-bar");
    await page.getByRole("button", { name: "Open a file" }).click();
    await page.getByRole("button", { name: "panda" }).first().click();
    await untilModel(page, "panda");
    await page.goto(`${server.url}?model=77`);
    await page.getByText(/model 77 is not open on this server/).first().waitFor();
    await page.getByRole("button", { name: "Open a file" }).click();
    await page.getByRole("button", { name: "five-bar" }).first().click();
    await untilModel(page, "five-bar");
  }, { expect: /WebSocket|422/ }));
