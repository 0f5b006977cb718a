/** A server that is restarted: the page opens its models again, once; an observer sends nothing. */
import assert from "node:assert/strict";
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import {
  addBeside, apart, beside, browserOfFile, enter, openFiles, openPanel, PATIENCE, picture, served, state, until, untilBeside, untilBesideAt, untilModel,
} from "./lib.mjs";

/** @typedef {import("playwright-core").Page} Page */

const { look, visit } = browserOfFile();
const folder = await mkdtemp(join(tmpdir(), "cylindroid-restart-"));

const CRANE = join(folder, "crane.urdf");
const MESH = join(folder, "a.stl");
await writeFile(CRANE, `<robot name="crane">
  <link name="base"/>
  <link name="arm"><visual><geometry><mesh filename="a.stl"/></geometry></visual></link>
  <joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
</robot>
`);
await writeFile(MESH, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n");

/**
 * Opens the crane, with its joint at 0.5.
 * @param {Page} page
 */
async function openCrane(page) {
  await openFiles(page, CRANE, MESH);
  await untilModel(page, "crane");
  await page.waitForFunction(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length === 1);
  await enter(page.getByLabel("lift as a number"), 0.5);
  await until(page, "state.q[0] === 0.5");
}

/**
 * Waits until the page has what opens its models again.
 * @param {Page} page
 * @param {number} count
 */
async function untilKept(page, count) {
  const end = performance.now() + PATIENCE;
  for (;;) {
    const kept = await page.evaluate(async () => (await Promise.all([.../** @type {any} */ (window).viewer.models.requests.values()])).length);
    if (kept === count) return;
    assert.ok(performance.now() < end, `${kept} models are kept`);
    await page.waitForTimeout(50);
  }
}

/**
 * Addresses to which the page sends something from now on.
 * @param {Page} page
 */
function sent(page) {
  /** @type {string[]} */
  const posts = [];
  page.on("request", (request) => request.method() === "POST" && posts.push(request.url()));
  return posts;
}

test("models that the page opened are opened again, with their joints, obstacles and places", () =>
  visit(["panda"], async (page, first) => {
    await openCrane(page);
    await openPanel(page, "obstacles");
    await page.getByRole("button", { name: "Add", exact: true }).click();
    await until(page, "state.obstacles.length === 1");
    await addBeside(page, "ur5e");
    await untilBeside(page, ["ur5e"]);
    await addBeside(page, "panda");
    await untilBeside(page, ["ur5e", "panda"]);
    for (const [i, value] of [0.75, -0.25].entries()) {
      await openPanel(page, `beside-${i + 1}`);
      await enter(page.locator(`[data-panel="beside-${i + 1}"] .field`).first(), value);
      await untilBesideAt(page, i, value);
    }
    await enter(page.locator('[data-beside="y"]').first(), -0.5);
    await page.getByLabel("Transparent").first().check();
    await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.beside[0].transparent);
    await untilKept(page, 2);
    const [was, stood, address, posts] = [await state(page), await beside(page), page.url(), sent(page)];
    await first.stop();
    await page.getByText("The server has stopped.").waitFor();
    await page.evaluate(() => {
      const { session, companions } = /** @type {any} */ (window).viewer;
      Object.assign(window, { last: [session, ...[...companions.all.values()].map((one) => one.session)].map((one) => one.state) });
    });
    await served(["panda", "--port", new URL(first.url).port], async (second) => {
      // Another model is opened there meanwhile, and has another address.
      await fetch(`${second.url}models`, { method: "POST", body: '{"open": "five-bar"}\n' });
      await page.getByText("The connection is restored, with the previous configuration.").waitFor();
      await page.waitForFunction(() => {
        const { viewer: { session, companions }, last } = /** @type {any} */ (window);
        const all = [session, ...[...companions.all.values()].map((one) => one.session)];
        return all.length === 3 && all.every(({ state }, i) => state && state !== last[i] && Math.abs(state.q[0] - last[i].q[0]) < 1e-9);
      });
      await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.scene.beside.length === 2);
      await until(page, "state.obstacles.length === 1");
      const [is, stands] = [await state(page), await beside(page)];
      assert.ok(apart(is.q, was.q) < 1e-12);
      assert.deepEqual(is.obstacles, was.obstacles);
      assert.deepEqual(stands.map(({ name, place }) => [name, place]), stood.map(({ name, place }) => [name, place]));
      stands.forEach(({ q }, i) => assert.ok(apart(q, stood[i]?.q ?? []) < 1e-9));
      assert.equal(page.url(), address);
      assert.equal(await page.evaluate(() => /** @type {any} */ (window).viewer.robot.links[1].shapes.children.length), 1);
      assert.equal(posts.length, 2, `${posts}`);
      await picture(page, "models-opened-again");
      // A page that comes now finds the model under its address.
      await look(address, (other) => untilModel(other, "crane"));
    });
  }, { expect: /WebSocket|net::ERR_/ }));

test("a server that opens no files is asked once, and says so once; the next one is asked again", () =>
  visit(["panda"], async (page, first) => {
    await openCrane(page);
    await untilKept(page, 1);
    const posts = sent(page);
    await page.evaluate(() => {
      /** @type {string[]} */
      const said = [];
      Object.assign(window, { said });
      const toasts = document.querySelector(".toasts");
      if (toasts) new MutationObserver((all) => all.forEach(({ addedNodes }) => addedNodes.forEach(({ textContent }) => said.push(textContent ?? "")))).observe(toasts, { childList: true });
    });
    await first.stop();
    await page.getByText("The server has stopped.").waitFor();
    await served(["panda", "--host", "0.0.0.0", "--port", new URL(first.url).port], async () => {
      await page.getByText(/could not be opened again.*opens no files/).waitFor();
      await page.getByText("The server does not have this model.").waitFor();
      // It goes on to look for the model, and sends nothing.
      await page.waitForTimeout(4000);
      await picture(page, "model-gone");
      assert.equal(posts.length, 1);
      const said = await page.evaluate(() => /** @type {any} */ (window).said);
      assert.equal(said.length, 1, `${said}`);
      await page.getByText("The server does not have this model.").waitFor();
    });
    await page.getByText("The server has stopped.").waitFor();
    await served(["panda", "--port", new URL(first.url).port], async () => {
      await page.getByText("The connection is restored, with the previous configuration.").waitFor();
      await until(page, "Math.abs(state.q[0] - 0.5) < 1e-9");
      assert.equal(posts.length, 2);
    });
  }, { expect: /WebSocket|net::ERR_|403/ }));

test("a model that nobody drove is opened again by a page that has driven", () =>
  served(["panda"], async (first) => {
    const opened = await (await fetch(`${first.url}models`, { method: "POST", body: '{"open": "ur5e"}\n' })).json();
    await look(`${first.url}?model=${opened.id}&session=demo`, async (page) => {
      await page.locator(".role").getByText("Driving, 1 page").waitFor();
      await enter(page.locator('[data-panel="joints"] .field').first(), 0.5);
      await until(page, "state.q[0] === 0.5");
      await untilKept(page, 1);
      await page.locator('[data-role="drive"]').click();
      await page.locator(".role").getByText("Nobody drives, 1 page").waitFor();
      const posts = sent(page);
      await first.stop();
      await page.getByText("The server has stopped.").waitFor();
      await served(["panda", "--port", new URL(first.url).port], async () => {
        await page.getByText("The connection is restored, with the previous configuration.").waitFor();
        await page.locator(".role").getByText("Driving, 1 page").waitFor();
        await until(page, "Math.abs(state.q[0] - 0.5) < 1e-9");
        assert.equal(posts.length, 1);
      });
    }, { expect: /WebSocket|net::ERR_/ });
  }));

test("an observer opens no model: the page that drives does", () =>
  served(["panda"], async (first) => {
    const opened = await (await fetch(`${first.url}models`, { method: "POST", body: '{"open": "ur5e"}\n' })).json();
    const address = `${first.url}?model=${opened.id}&session=demo`;
    await look(address, async (driver) => {
      await driver.locator(".role").getByText("Driving, 1 page").waitFor();
      await look(address, async (observer) => {
        await observer.locator(".role").getByText("Observing, 2 pages").waitFor();
        await addBeside(driver, "3r");
        for (const page of [driver, observer]) await untilBeside(page, ["3r"]);
        await enter(driver.locator('[data-panel="joints"] .field').first(), 0.5);
        for (const page of [driver, observer]) await until(page, "state.q[0] === 0.5");
        await untilKept(driver, 2);
        const posts = sent(observer);
        // The driver waits until it is told to come back.
        await driver.evaluate(() => {
          const { session, companions } = /** @type {any} */ (window).viewer;
          for (const one of [session, ...[...companions.all.values()].map((all) => all.session)]) one.connection.pause = 600;
        });
        await first.stop();
        for (const page of [driver, observer]) {
          await page.getByText("The server has stopped.").waitFor();
          await page.evaluate(() => Object.assign(window, { last: /** @type {any} */ (window).viewer.session.state }));
        }
        await served(["panda", "--port", new URL(first.url).port], async () => {
          await observer.getByText("The server does not have this model.").waitFor();
          await observer.waitForTimeout(2000);
          assert.deepEqual(posts, []);
          await driver.getByRole("button", { name: "Reconnect now" }).click();
          for (const page of [driver, observer]) {
            await page.waitForFunction(() => /** @type {any} */ (window).viewer.session.about?.clients === 2);
            await until(page, "state !== window.last && Math.abs(state.q[0] - 0.5) < 1e-9");
            await untilBeside(page, ["3r"]);
          }
          assert.deepEqual(await Promise.all([driver, observer].map((page) => page.evaluate(() => /** @type {any} */ (window).viewer.session.drives))), [true, false]);
          assert.deepEqual(posts, []);
        });
      }, { expect: /WebSocket|net::ERR_/ });
    }, { expect: /WebSocket|net::ERR_/ });
  }));

test("an observer that comes back before the driver lets it drive again", () =>
  served(["panda"], async (first) => {
    const opened = await (await fetch(`${first.url}models`, { method: "POST", body: '{"open": "ur5e"}\n' })).json();
    const address = `${first.url}?model=${opened.id}&session=demo`;
    const options = { expect: /WebSocket|net::ERR_/ };
    await look(address, (driver) => look(address, async (observer) => {
      await observer.locator(".role").getByText("Observing, 2 pages").waitFor();
      await enter(driver.locator('[data-panel="joints"] .field').first(), 0.5);
      for (const page of [driver, observer]) await until(page, "state.q[0] === 0.5");
      await addBeside(driver, "3r");
      for (const page of [driver, observer]) await untilBeside(page, ["3r"]);
      await untilKept(driver, 2);
      // The driver opens the model when it is told to, and comes when it is told to.
      await driver.evaluate(() => {
        const { connection } = /** @type {any} */ (window).viewer.session;
        const renew = connection.renew.bind(connection);
        connection.pause = 600;
        connection.renew = () => {
          connection.pause = 600;
          renew();
          connection.renew = () => Object.assign(window, { come: renew });
        };
      });
      // The observer lets go when it is told to.
      await observer.evaluate(() => {
        const { session } = /** @type {any} */ (window).viewer;
        const send = session.send.bind(session);
        session.send = (/** @type {any} */ message) => {
          if (message.type !== "drive") return send(message);
          return Object.assign(window, { release: () => send(message) });
        };
      });
      await first.stop();
      for (const page of [driver, observer]) await page.getByText("The server has stopped.").waitFor();
      await served(["panda", "--port", new URL(first.url).port], async () => {
        await driver.getByRole("button", { name: "Reconnect now" }).click();
        await driver.waitForFunction(() => "come" in window);
        await observer.waitForFunction(() => "release" in window && /** @type {any} */ (window).viewer.session.drives);
        await driver.evaluate(() => /** @type {any} */ (window).come());
        await driver.locator(".role").getByText("Observing, 2 pages").waitFor();
        await observer.evaluate(() => /** @type {any} */ (window).release());
        await driver.locator(".role").getByText("Driving, 2 pages").waitFor();
        await observer.locator(".role").getByText("Observing, 2 pages").waitFor();
        for (const page of [driver, observer]) await until(page, "Math.abs(state.q[0] - 0.5) < 1e-9");
        // So it does what stands beside the model.
        for (const page of [driver, observer]) await untilBeside(page, ["3r"]);
        const drives = (/** @type {Page} */ page) => page.evaluate(() => [.../** @type {any} */ (window).viewer.companions.all.values()].map(({ session }) => session.drives));
        await driver.waitForFunction(() => [.../** @type {any} */ (window).viewer.companions.all.values()].every(({ session }) => session.drives));
        assert.deepEqual(await drives(observer), [false]);
        // Once: what it releases later is free.
        await driver.locator('[data-role="drive"]').click();
        await driver.locator(".role").getByText("Nobody drives, 2 pages").waitFor();
      });
    }, options), options);
  }));
