/** Pages of one session: one drives, the others observe and can take over. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { browserOfFile, drag, moveTarget, openPanel, PATIENCE, picture, served, state, until, untilNear } from "./lib.mjs";

const { look } = browserOfFile();

const NAMED = "?session=demo";

test("an observer sees what the driver does, cannot drive, and takes over", () =>
  served(["panda"], ({ url }) =>
    look(url + NAMED, async (driver) => {
      await driver.locator(".role[title='Session demo']").getByText("Driving, 1 page").waitFor();
      await look(url + NAMED, async (observer) => {
        await driver.locator(".role").getByText("Driving, 2 pages").waitFor();
        await observer.locator(".role").getByText("Observing, 2 pages").waitFor();

        const target = await moveTarget(driver, "z", 0.05);
        await untilNear(observer, "state.target.position", target, 1e-6);
        await until(observer, 'state.servo.status === "reached"');
        const done = await same(driver, observer);

        // Neither by its controls nor by its handle.
        assert.ok(await observer.getByRole("button", { name: "Reset" }).isDisabled());
        assert.ok(await observer.locator('[data-panel="joints"] .body').evaluate((body) => /** @type {HTMLElement} */ (body).inert));
        await drag(observer, [0, 0.1, 0]);
        // What it sees is its own choice.
        await openPanel(observer, "show");
        await observer.locator('[data-overlay="joint-axes"]').check();
        await until(observer, 'state.overlays["joint-axes"] !== undefined');
        await picture(observer, "observer");
        assert.deepEqual((await state(driver)).target.position, done.target.position);
        assert.equal((await state(driver)).overlays["joint-axes"], undefined);

        await observer.locator('[data-role="drive"]').click();
        await observer.locator(".role").getByText("Driving, 2 pages").waitFor();
        await driver.locator(".role").getByText("Observing, 2 pages").waitFor();
        const next = await moveTarget(observer, "z", -0.03);
        await untilNear(driver, "state.target.position", next, 1e-6);
        await observer.locator('[data-role="drive"]').click();
        await driver.locator(".role").getByText("Nobody drives").waitFor();
      });
      await driver.locator(".role").getByText("Nobody drives, 1 page").waitFor();
      await driver.locator('[data-role="drive"]').click();
      await moveTarget(driver, "z", 0.02);
      await picture(driver, "driver");
    })));

/**
 * Waits until both pages have drawn the same state, whose numbers are then the same.
 * @param {import("playwright-core").Page} one
 * @param {import("playwright-core").Page} other
 */
async function same(one, other) {
  const end = performance.now() + PATIENCE;
  for (;;) {
    const [a, b] = await Promise.all([state(one), state(other)]);
    if (a.seq === b.seq && a.servo.status === "reached") {
      assert.deepEqual(a.q, b.q);
      return a;
    }
    assert.ok(performance.now() < end, `states ${a.seq} and ${b.seq}`);
  }
}

test("a page that comes back finds its session as the others have it", () =>
  served(["panda"], ({ url }) =>
    look(url + NAMED, async (first) => {
      await look(url + NAMED, async (second) => {
        const target = await moveTarget(first, "z", 0.05);
        await untilNear(second, "state.target.position", target, 1e-6);
        await first.reload();
        await first.locator(".role").getByText("Driving, 2 pages").waitFor();
        await untilNear(first, "state.target.position", target, 1e-6);
      });
    })));

test("two pages of a session find it again on a server that was restarted; the driver drives", () =>
  served(["panda"], (first) =>
    look(first.url + NAMED, async (driver) => {
      await driver.locator(".role").getByText("Driving, 1 page").waitFor();
      await look(first.url + NAMED, async (observer) => {
        await observer.locator(".role").getByText("Observing, 2 pages").waitFor();
        const target = await moveTarget(driver, "z", 0.05);
        // The servo goes on within its tolerance: what comes back is compared with what is at rest.
        await until(driver, 'state.servo.status === "reached" && state.servo.joint_velocities.every((rate) => rate === 0)');
        const { q } = await same(driver, observer);
        // The driver waits until it is told to come back.
        await driver.evaluate(() => void (/** @type {any} */ (window).viewer.session.connection.pause = 600));
        await first.stop();
        for (const page of [driver, observer]) await page.getByText("The server has stopped.").waitFor();
        await served(["panda", "--port", new URL(first.url).port], async () => {
          // The observer comes first, and finds nothing there.
          await untilNear(observer, "state.target.position", target, 1e-6);
          await observer.locator(".role").getByText("Nobody drives, 1 page").waitFor();
          await driver.getByRole("button", { name: "Reconnect now" }).click();
          await driver.locator(".role").getByText("Driving, 2 pages").waitFor();
          for (const page of [driver, observer]) {
            await untilNear(page, "state.target.position", target, 1e-6);
            await untilNear(page, "state.q", q, 1e-9);
          }
        });
      }, { expect: /WebSocket|net::ERR_/ });
    }, { expect: /WebSocket|net::ERR_/ })));

test("a page alone has no role", () =>
  served(["panda"], ({ url }) =>
    look(url, async (page) => {
      assert.ok(await page.locator('[data-role="drive"]').isHidden());
    })));
