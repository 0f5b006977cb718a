/** Pages that follow a program in Python: a loop at 100 Hz, and a notebook. Run by `cargo xtask python`. */
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createServer } from "node:http";
import { createInterface } from "node:readline";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { browserOfFile, drawn, launch, picture, state, until, untilNear } from "./lib.mjs";

const { look } = browserOfFile();

/**
 * A script in Python, until the work is done: its lines come in order, and a line to it lets it go on.
 * @param {string} name
 * @param {(script: { line: () => Promise<string>, on: () => void }) => Promise<void>} work
 */
async function python(name, work) {
  const script = fileURLToPath(new URL(`python/${name}`, import.meta.url));
  const child = spawn(process.env["CYLINDROID_PYTHON"] ?? "python3", [script], { stdio: ["pipe", "pipe", "inherit"] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const line = async () => {
    const { value, done } = await lines.next();
    assert.ok(!done, `${name} ended`);
    return String(value);
  };
  try {
    await work({ line, on: () => void child.stdin.write("\n") });
  } finally {
    child.kill("SIGKILL");
  }
}

test("two pages follow a loop at 100 Hz", () =>
  python("loop.py", async ({ line, on }) => {
    const url = await line();
    await look(url, (first) =>
      look(url, async (second) => {
        const pages = [first, second];
        for (const page of pages) {
          await page.evaluate(() => {
            const { session } = /** @type {any} */ (window).viewer;
            /** @type {[number, number][]} */
            const seen = [];
            Object.assign(window, { seen });
            // As it comes, before it waits for a frame.
            session.on("raw", (/** @type {string} */ raw) => {
              const now = Date.now();
              seen.push([Math.round(1e3 * JSON.parse(raw).q[0]), now]);
            });
          });
        }
        on();
        const times = /** @type {number[]} */ (JSON.parse(await line()));
        for (const page of pages) {
          await until(page, "Math.abs(state.q[0] - 0.499) < 1e-9");
          const seen = await page.evaluate(() => /** @type {[number, number][]} */ (/** @type {any} */ (window).seen));
          const late = seen.filter(([k]) => k > 0).map(([k, time]) => time - (times[k] ?? NaN)).sort((a, b) => a - b);
          const share = (/** @type {number} */ of) => late[Math.floor(of * (late.length - 1))] ?? NaN;
          const words = `${share(0.5).toFixed(0)} ms (median), ${share(0.95).toFixed(0)} ms (95 %), ${share(1).toFixed(0)} ms (most)`;
          console.log(`${late.length} of ${times.length} configurations came; late by ${words}`);
          assert.ok(late.length > 10);
          assert.equal((await state(page)).servo.sentence, "A program sets the configuration.");
        }
        await picture(second, "python-loop");
      }));
  }));

test("a notebook shows the view below its cell", () =>
  python("notebook.py", async ({ line }) => {
    const outputs = JSON.parse(await line());
    const html = outputs[0][0].data["text/html"];
    assert.match(html, /<iframe/);
    // A page as that of Jupyter: another origin on this machine.
    const server = createServer((_, answer) => answer.setHeader("content-type", "text/html").end(`<title>notebook</title><h1>In [1]</h1>${html}`));
    await new Promise((done) => server.listen(0, "127.0.0.1", () => done(undefined)));
    const address = server.address();
    const port = typeof address === "object" ? address?.port : 0;
    const browser = await launch();
    try {
      const page = await browser.newPage({ viewport: { width: 1300, height: 720 } });
      await page.goto(`http://localhost:${port}/`);
      const frame = page.frames().find((child) => child !== page.mainFrame());
      assert.ok(frame, "there is no frame");
      await drawn(/** @type {any} */ (frame));
      await untilNear(/** @type {any} */ (frame), "state.q.slice(0, 1)", [0.5]);
      await frame.locator(".label", { hasText: "grasp" }).waitFor();
      await picture(page, "notebook");
    } finally {
      await browser.close();
      server.close();
    }
  }));
