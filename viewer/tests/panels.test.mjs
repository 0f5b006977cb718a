/** Panels keep their nodes: focus stays where it is, states move no elements, folded panels cost nothing. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { browserOfFile, drawn, enter, moveTarget, openPanel, scene, until, untilReached } from "./lib.mjs";

const { visit } = browserOfFile();

const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));

/**
 * Marks the element in focus, and later says whether the focus is still on it.
 * @param {import("playwright-core").Page} page
 */
async function holdFocus(page) {
  const held = await page.evaluateHandle(() => document.activeElement);
  return async (/** @type {string} */ what) => {
    // A scene is drawn with the frame after it.
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const now = await page.evaluate((element) => (document.activeElement === element ? "" : (document.activeElement?.outerHTML ?? "").slice(0, 80)), held);
    assert.equal(now, "", `the focus left ${what}`);
  };
}

/**
 * A server whose answers about mobility come late; counts them, and the most requests without an answer.
 * @param {import("playwright-core").Page} page
 */
async function slowMobility(page) {
  const counts = { most: 0, answers: 0 };
  await page.routeWebSocket(/./, (socket) => {
    const server = socket.connectToServer();
    const open = new Set();
    socket.onMessage((text) => {
      const { type, name, id } = JSON.parse(String(text));
      if (type === "report" && name === "mobility") counts.most = Math.max(counts.most, open.add(id).size);
      server.send(text);
    });
    server.onMessage((text) => {
      const { type, name, reply_to } = JSON.parse(String(text));
      if (type !== "report" || name !== "mobility") return socket.send(text);
      setTimeout(() => {
        open.delete(reply_to);
        counts.answers += 1;
        socket.send(text);
      }, 1500);
    });
  });
  await page.reload();
  await drawn(page);
  return counts;
}

test("a report is asked for again only after its answer, and then for what has changed since", () =>
  visit(["panda"], async (page) => {
    const counts = await slowMobility(page);
    await openPanel(page, "mobility");
    // The robot moves on before it answers.
    for (const by of [-0.03, -0.03]) await moveTarget(page, "z", by);
    await untilReached(page, await moveTarget(page, "z", -0.03));
    await page.locator('[data-panel="mobility"] dl').first().waitFor();
    await page.waitForTimeout(4000);
    assert.equal(counts.most, 1, "requests without an answer");
    assert.ok(counts.answers > 1, "asked for after the robot moved");
  }));

test("frames that are chosen faster than reports come are one request at a time; that of the last is shown", () =>
  visit(["panda"], async (page) => {
    const counts = await slowMobility(page);
    const panel = await openPanel(page, "mobility");
    await panel.locator("dl").first().waitFor();
    const before = counts.answers;
    for (const name of ["link5", "link4", "link3", "link2"]) {
      await page.getByLabel("Frame", { exact: true }).selectOption(name);
      await until(page, `scene.frame === "${name}"`);
      await page.waitForTimeout(400);
    }
    assert.equal(counts.most, 1, "requests without an answer");
    // Two joints carry link2.
    await panel.locator("dt:text('controllable object motions') + dd:text-is('2')").waitFor();
    assert.ok(counts.answers > before);
  }));

test("answers that come after another frame was chosen are not shown", () =>
  visit(["panda"], async (page) => {
    for (const name of ["mobility", "compare"]) {
      const panel = await openPanel(page, name);
      await panel.locator("dl, table").first().waitFor();
    }
    await page.evaluate(() => {
      /** @type {any} */
      const { session } = /** @type {any} */ (window).viewer;
      const [emit, heard] = [session.emit.bind(session), /** @type {any[]} */ ([])];
      /** @type {any} */ (window).heard = heard;
      session.emit = (/** @type {string} */ name, /** @type {any} */ value) => {
        if (name === "compare" || value?.name === "mobility") heard.push([name, value]);
        return emit(name, value);
      };
    });
    await untilReached(page, await moveTarget(page, "z", -0.02));
    await until(page, '["compare", "report"].every((name) => window.heard.some((one) => one[0] === name))');
    await page.getByLabel("Frame", { exact: true }).selectOption("link5");
    await until(page, 'scene.frame === "link5"');
    await page.waitForTimeout(1500);
    const [before, after] = await page.evaluate(() => {
      const text = () => ["mobility", "compare"].map((name) => document.querySelector(`[data-panel="${name}"]`)?.textContent);
      const before = text();
      /** @type {any} */
      const { session } = /** @type {any} */ (window).viewer;
      for (const which of ["compare", "report"]) {
        const [name, value] = /** @type {any} */ (window).heard.find((/** @type {any} */ one) => one[0] === which);
        // The answer of before, with other numbers.
        session.emit(name, JSON.parse(JSON.stringify(value).replaceAll(/\d\.\d+/g, "7.7")));
        session.emit("failure", { type: "error", reply_to: value.reply_to, message: "refused" });
      }
      return [before, text()];
    });
    assert.deepEqual(after, before);
  }));

test("the focus stays on a switch of an actuated joint, on a list and on the buttons of the handle", () =>
  visit(["five-bar"], async (page) => {
    const actuator = page.locator('[data-actuator="q5"]');
    await actuator.focus();
    let same = await holdFocus(page);
    await page.keyboard.press("Space");
    await until(page, "scene.actuators.filter((joint) => joint.actuated).length === 3");
    await same("the switch of q5");
    assert.ok(await actuator.isChecked());
    await page.keyboard.press("Space");
    await until(page, "scene.actuators.filter((joint) => joint.actuated).length === 2");
    await same("the switch of q5");
    for (const [label, wanted] of /** @type {const} */ ([["Inverse", 'scene.method.name === "damped"'], ["Task", 'scene.task.name === "position"']])) {
      const list = page.getByLabel(label, { exact: true });
      await list.focus();
      same = await holdFocus(page);
      await list.selectOption(label === "Inverse" ? "damped" : "position");
      await until(page, wanted);
      await same(label);
    }
    for (const name of ["Move", "tool axes"]) {
      await page.getByRole("button", { name, exact: true }).focus();
      same = await holdFocus(page);
      await page.keyboard.press("Enter");
      await same(name);
    }
  }));

test("the focus stays on Rotate, on a parameter of the inverse, on an overlay and on a field of an obstacle", () =>
  visit([CELL], async (page) => {
    const rotate = page.getByRole("button", { name: "Rotate", exact: true });
    await rotate.focus();
    let same = await holdFocus(page);
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Rotate", exact: true, pressed: true }).waitFor();
    await same("Rotate");
    await page.getByLabel("Inverse", { exact: true }).selectOption("damped");
    await until(page, 'scene.method.name === "damped"');
    const damping = page.getByLabel(/^damping/);
    await damping.focus();
    same = await holdFocus(page);
    await enter(damping, 0.07);
    await until(page, "scene.method.parameters.damping === 0.07");
    await same("the field of the damping");
    await page.locator('[data-overlay="joint-axes"]').focus();
    same = await holdFocus(page);
    await page.keyboard.press("Space");
    await until(page, 'state.overlays["joint-axes"] !== undefined');
    await same("the switch of an overlay");
    const panel = await openPanel(page, "obstacles");
    const add = panel.getByRole("button", { name: "Add" });
    await add.focus();
    same = await holdFocus(page);
    await page.keyboard.press("Enter");
    await until(page, "scene.obstacles.length === 1 && state.obstacles.length === 1");
    await same("Add");
    const z = panel.getByLabel("z of sphere 1 in the world frame (m)");
    await z.focus();
    same = await holdFocus(page);
    await enter(z, 0.9);
    await until(page, "Math.abs(state.obstacles[0].position[2] - 0.9) < 1e-9");
    await page.evaluate(() => /** @type {any} */ (window).viewer.session.send({ type: "add_obstacle", name: "other", shape: { kind: "sphere", radius: 0.1 }, position: [2, 2, 2], quaternion: [1, 0, 0, 0] }));
    await until(page, "scene.obstacles.length === 2 && state.obstacles.length === 2");
    await same("the field of an obstacle");
    await panel.getByRole("button", { name: "Remove sphere 1" }).focus();
    await page.keyboard.press("Enter");
    await until(page, 'scene.obstacles.length === 1 && scene.obstacles[0].name === "other"');
    await page.waitForFunction(() => document.activeElement?.textContent === "Add");
  }));

test("a refused choice of actuated joints leaves the switch as the server has it", () =>
  visit(["five-bar"], async (page) => {
    await page.evaluate(() => {
      const { session } = /** @type {any} */ (window).viewer;
      const send = session.send.bind(session);
      session.send = (/** @type {any} */ message) => send(message.type === "actuated" ? { ...message, names: ["nothing"] } : message);
    });
    const box = page.locator('[data-actuator="q5"]');
    await box.click();
    await page.locator(".toast.bad").waitFor();
    assert.equal(await box.isChecked(), (await scene(page)).actuators.find(({ name }) => name === "q5")?.actuated);
  }));

test("a panel that is opened at rest shows the state, and bars take the width that there is", () =>
  visit(["panda"], async (page) => {
    await until(page, 'state.servo.status === "reached"');
    const summary = page.locator('[data-panel="singular"] > summary');
    await summary.click();
    await page.waitForFunction(() => localStorage.getItem("cylindroid-panel-singular") === "false");
    await page.reload();
    await until(page, 'state.servo.status === "reached"');
    assert.equal(await page.locator(".bars rect").count(), 0, "folded, it draws no bars");
    await summary.click();
    await page.waitForFunction(() => document.querySelectorAll(".bars rect").length === 6);
    const fits = () => page.waitForFunction(() => {
      const [bars, body] = [".bars", '[data-panel="singular"] > .body'].map((name) => document.querySelector(name));
      return Number(bars?.getAttribute("viewBox")?.split(" ")[2]) === (body?.clientWidth ?? 0) - 28;
    });
    await fits();
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForFunction(() => (document.querySelector('[data-panel="singular"] > .body')?.clientWidth ?? 0) > 350);
    await fits();
  }));

/**
 * Shows a state of which parts are others.
 * @param {import("playwright-core").Page} page
 * @param {object} parts
 */
const showOther = (page, parts) => page.evaluate((others) => {
  const { session } = /** @type {any} */ (window).viewer;
  session.state = { ...session.state, ...others };
  session.emit("state", session.state);
}, parts);

test("a gap of null is none lost at full rank, infinite below it; a rotation has one quaternion", () =>
  visit(["panda", "--q=0.3,0.2,0.1,-1.2,0.3,1.4,0.5"], async (page) => {
    await until(page, 'state.servo.status === "reached"');
    const values = [2, 1, 0.5, 0.2, 0.1];
    const singular = (/** @type {number} */ last) => ({ singular: { values: [...values, last], threshold: 0.002, rank: last > 0 ? 6 : 5, gap: null, ratio: last / 2, length: 0.5 } });
    const panel = page.locator('[data-panel="singular"]');
    await showOther(page, singular(0.05));
    assert.match(await panel.innerText(), /none lost/);
    await showOther(page, singular(0));
    const words = await panel.innerText();
    assert.match(words, /∞/);
    assert.match(words, /0 lost/);
    assert.doesNotMatch(words, /none lost/);
    assert.match(words, /rank 5 of 6/);
    const { tool, target } = await page.evaluate(() => /** @type {any} */ (window).viewer.session.state);
    await showOther(page, { target: { ...target, quaternion: tool.quaternion.map((/** @type {number} */ part) => -part) } });
    const rows = await page.locator("tr", { has: page.locator('[data-pose^="q"]') }).evaluateAll((all) => all.map((row) => [...row.querySelectorAll("td")].map((cell) => cell.textContent)));
    assert.equal(rows.length, 4);
    for (const [here, there] of rows) assert.equal(here, there);
  }));

const FOLDING = ["joints", "show", "servo", "pose", "singular", "screws"];

for (const folded of [false, true]) {
  test(`while the tool moves ${folded ? "folded panels do not change" : "panels and legend make no elements"}`, (t) =>
    visit(["panda"], async (page) => {
      await page.locator('[data-overlay="velocity-ellipsoid"]').check();
      await page.locator('[data-overlay="joint-axes"]').check();
      await until(page, 'state.overlays["joint-axes"] !== undefined && state.overlays["principal-screws"] !== undefined');
      if (folded) {
        for (const name of FOLDING) await page.locator(`[data-panel="${name}"] > summary`).click();
        await until(page, 'state.overlays["principal-screws"] === undefined');
      }
      await page.evaluate((changesCount) => {
        const { session } = /** @type {any} */ (window).viewer;
        /** @type {{ states: number, work: number, changes: string[] }} */
        const seen = { states: 0, work: 0, changes: [] };
        const emit = session.emit.bind(session);
        session.emit = (/** @type {string} */ event, /** @type {unknown} */ value) => {
          const begin = performance.now();
          emit(event, value);
          if (event !== "state") return;
          seen.work += performance.now() - begin;
          seen.states += 1;
        };
        const observer = new MutationObserver((all) => {
          for (const { type, target, addedNodes, attributeName } of all) {
            const made = [...addedNodes].filter((node) => node instanceof Element);
            if (changesCount || made.length > 0) seen.changes.push(`${type} ${attributeName ?? ""} of ${target.nodeName}: ${made.map((node) => node.nodeName).join()}`);
          }
        });
        for (const body of document.querySelectorAll(".panel > .body, .legend")) {
          if (!(changesCount && body.classList.contains("legend"))) observer.observe(body, { subtree: true, childList: true, attributes: changesCount, characterData: changesCount });
        }
        Object.assign(window, { seen });
      }, folded);
      await untilReached(page, await (folded ? sendTarget(page, -0.08) : moveTarget(page, "z", -0.08)));
      /** @type {{ states: number, work: number, changes: string[] }} */
      const { states, work: spent, changes } = await page.evaluate(() => /** @type {any} */ (window).seen);
      t.diagnostic(`${(spent / states).toFixed(2)} ms of JavaScript for a state, ${folded ? "panels folded" : "panels open"}`);
      assert.ok(states > 5, `${states} states`);
      assert.deepEqual([...new Set(changes)], []);
      await countWork(page);
      await untilReached(page, await sendTarget(page, 0.08));
      const work = await page.evaluate(() => /** @type {any} */ (window).work);
      t.diagnostic(`${(work.calls / work.states).toFixed(1)} reads and writes of elements in panels for a state`);
      assert.ok(work.states > 5, `${work.states} states`);
      if (folded) assert.deepEqual([...new Set(work.of)], [], "work in folded panels");
      else assert.ok(work.calls > 20 * work.states, `${work.calls} calls`);
    }));
}

/**
 * Counts in `window.work` what the page reads and writes of elements in panels while it shows a state, new elements among them.
 * @param {import("playwright-core").Page} page
 */
function countWork(page) {
  return page.evaluate(() => {
    /** @type {{ states: number, calls: number, of: string[] }} */
    const work = { states: 0, calls: 0, of: [] };
    let counts = false;
    const { session } = /** @type {any} */ (window).viewer;
    const emit = session.emit.bind(session);
    session.emit = (/** @type {string} */ event, /** @type {unknown} */ value) => {
      work.states += event === "state" ? 1 : 0;
      counts = event === "state";
      emit(event, value);
      counts = false;
    };
    const note = (/** @type {any} */ node, /** @type {string} */ name) => {
      if (!counts || !(node instanceof Node)) return;
      const element = node instanceof Element ? node : node.parentElement;
      const panel = element?.closest("[data-panel]")?.getAttribute("data-panel");
      // An element that is made is nowhere yet; labels of the view are.
      if (!panel || !element?.closest(".body")) return;
      work.calls += 1;
      work.of.push(`${name} in ${panel}`);
    };
    for (const [owner, ...names] of /** @type {[any, ...string[]][]} */ ([
      [Node.prototype, "textContent", "appendChild"],
      [Element.prototype, "setAttribute", "removeAttribute", "replaceChildren", "append", "className", "clientWidth"],
      [HTMLElement.prototype, "style", "dataset", "hidden"],
      [HTMLInputElement.prototype, "value", "checked"],
    ])) {
      for (const name of names) {
        const { value, get, set, ...rest } = /** @type {PropertyDescriptor} */ (Object.getOwnPropertyDescriptor(owner, name));
        const counted = (/** @type {Function} */ work) => function (/** @type {any[]} */ ...given) {
          // @ts-expect-error: of the element
          const node = this;
          note(node, name);
          return work.apply(node, given);
        };
        Object.defineProperty(owner, name, value ? { ...rest, value: counted(value) } : { configurable: true, enumerable: true, ...(get && { get: counted(get) }), ...(set && { set: counted(set) }) });
      }
    }
    Object.assign(window, { work });
  });
}

/**
 * Moves the target without the fields.
 * @param {import("playwright-core").Page} page
 * @param {number} by along z (m)
 */
function sendTarget(page, by) {
  return page.evaluate((by) => {
    const { session } = /** @type {any} */ (window).viewer;
    const { position: [x, y, z], quaternion } = session.state.target;
    const position = [x, y, z + by];
    session.send({ type: "target", position, quaternion });
    return position;
  }, by);
}
