/** The page at every width, light and dark: nothing is cut or hidden, edges and text have contrast, axe-core finds nothing. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { browserOfFile, moveTarget, openPanel, picture, served, showOverlay } from "./lib.mjs";

const { look, visit } = browserOfFile();

const CELL = fileURLToPath(new URL("../../docs/cell.toml", import.meta.url));
/** Width, height, and whether it is looked at light alone or dark as well. */
const SIZES = /** @type {const} */ ([[390, 844, 2], [768, 1024, 1], [830, 700, 1], [844, 390, 2], [1100, 800, 2], [1366, 768, 2], [1920, 1080, 2]]);
const ALL = ["plots", "joints", "show", "model", "obstacles", "servo", "units", "pose", "singular", "distances", "screws", "mobility", "capability", "compare"];

/**
 * Buttons of the bar and the view that are outside of the window, or under something else.
 * @param {import("playwright-core").Page} page
 */
const outOfReach = (page) => page.evaluate(() => [...document.querySelectorAll(".bar button, .bar .status, .float button, .dock :is(button, select, input)")].filter((element) => {
  const box = element.getBoundingClientRect();
  if (box.width === 0) return false;
  const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
  return box.left < 0 || box.right > innerWidth + 0.5 || box.bottom > innerHeight + 0.5 || !top || !(element.contains(top) || top.contains(element));
}).map((element) => element.getAttribute("aria-label") ?? element.textContent));

/**
 * What is wider than the window.
 * @param {import("playwright-core").Page} page
 */
const wide = (page) => page.evaluate(() => {
  const wanted = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth <= wanted) return [];
  return [...document.querySelectorAll("body *")].filter((element) => element.getBoundingClientRect().right > wanted + 0.5).map((element) => `${element.tagName}.${element.getAttribute("class")}`);
});

/**
 * Elements of the panels whose words or numbers run out of their place.
 * @param {import("playwright-core").Page} page
 */
const cut = (page) => page.evaluate(() => {
  const words = [...document.querySelectorAll(":is(.side, .plots) *")].filter((element) => element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).overflowX === "visible" && element.clientWidth > 0);
  // By the width of their text: `scrollWidth` of a field between two pixels may be one more than `clientWidth` where all is in sight.
  const context = new OffscreenCanvas(1, 1).getContext("2d");
  if (!context) throw new Error("no canvas measures text");
  const fields = [.../** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll("input.field"))].filter((field) => {
    const style = getComputedStyle(field);
    const [width, left, right] = [style.width, style.paddingLeft, style.paddingRight].map(parseFloat);
    const border = field.offsetWidth - field.clientWidth;
    const room = style.boxSizing === "border-box" ? (width ?? 0) - (left ?? 0) - (right ?? 0) - border : width ?? 0;
    context.font = style.font;
    return room > 0 && context.measureText(field.value).width > room;
  });
  return [...words, ...fields].map((element) => `${element.tagName}.${element.className} ${element.getAttribute("aria-label") ?? element.textContent?.slice(0, 40)}`);
});

for (const [width, height, looks] of SIZES) {
  test(`at ${width} x ${height} every button is in the window and nothing is cut`, () =>
    served([CELL, "--obstacle", "ball=sphere:0.08@0.4,0.25,0.3"], async ({ url }) => {
      for (const dark of [false, true].slice(0, looks)) {
        await look(url, async (page) => {
          await page.getByRole("button", { name: "Record" }).click();
          await moveTarget(page, "z", -0.05);
          await page.getByRole("button", { name: /^Stop recording/ }).click();
          for (const name of ["velocity-ellipsoid", "joint-axes", "principal-screws", "lost-direction"]) await showOverlay(page, name);
          await page.evaluate(() => scrollTo(0, 0));
          assert.deepEqual(await outOfReach(page), []);
          assert.deepEqual(await wide(page), [], "wider than the window");
          const [view, legend] = await page.evaluate(() => ["canvas", ".legend"].map((name) => document.querySelector(name)?.getBoundingClientRect().toJSON()));
          assert.ok(legend.height > 20 && legend.top >= view.bottom - 0.5, "the legend is below the view");
          assert.ok(view.height > 0.4 * Math.min(height, 500), `the view has ${view.height} of ${height}`);
          await picture(page, `layout-${width}-${dark ? "dark" : "light"}`);
          for (const name of ALL) await openPanel(page, name);
          await page.locator('[data-panel="compare"] table').waitFor();
          await page.locator('[data-panel="mobility"] dl').first().waitFor();
          assert.deepEqual(await cut(page), []);
          for (const [label, unit] of /** @type {const} */ ([["Orientation", "roll, pitch, yaw"], ["Length", "mm"], ["Angle", "deg"]])) {
            await page.getByLabel(label, { exact: true }).selectOption(unit);
          }
          assert.deepEqual(await cut(page), []);
          await page.locator('[data-panel="obstacles"]').scrollIntoViewIfNeeded();
          await picture(page, `layout-${width}-${dark ? "dark" : "light"}-panels`);
          await page.getByLabel("Reference point y (mm)").evaluate((field) => Object.assign(field, { value: "1".repeat(150) }));
          assert.deepEqual(await cut(page), ["INPUT.field Reference point y (mm)"], "what is cut is found");
        }, { width, height, dark });
      }
    }));
}

/** Where there are such edges, all of them in sight of the test. */
const PLACES = [".bar .button", ".float .button", ".side .field", ".side .switch", ".velocity", ".tree", ".companion .field", ".dock .select", ".dock .button", ".plots .button", ".chart-entry .stroke", "dialog .button"];
const EDGES = ".button, .select, .field, .switch, .tree, .velocity, dialog.open";

test("edges of controls, tracks of sliders and lines of plots have a contrast of 3 to 1", () =>
  visit(["panda"], async (page) => {
    for (const name of ["servo", "model"]) await openPanel(page, name);
    await page.evaluate(() => /** @type {any} */ (window).viewer.companions.add(null));
    await page.locator(".companion [data-joint]").first().waitFor({ state: "attached" });
    await page.getByRole("button", { name: "Record" }).click();
    await moveTarget(page, "z", -0.05);
    await page.getByRole("button", { name: /^Stop recording/ }).click();
    // One line of each colour.
    await page.waitForFunction(() => document.querySelectorAll('[data-plot="joints"] .chart-entry').length >= 7);
    await page.getByRole("button", { name: "Open a file" }).click();
    await page.locator("dialog").getByText("Catalogue").waitFor();
    for (const dark of [false, true]) {
      await page.emulateMedia({ colorScheme: dark ? "dark" : "light" });
      await page.waitForFunction((theme) => document.documentElement.dataset["theme"] === theme, dark ? "dark" : "light");
      const low = await page.evaluate(([places, edges]) => {
        const context = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
        const luminance = (/** @type {string} */ colour) => {
          if (!context) return 0;
          context.fillStyle = colour;
          context.fillRect(0, 0, 1, 1);
          const linear = [...context.getImageData(0, 0, 1, 1).data].slice(0, 3).map((byte) => byte / 255).map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
          return 0.2126 * (linear[0] ?? 0) + 0.7152 * (linear[1] ?? 0) + 0.0722 * (linear[2] ?? 0);
        };
        const contrast = (/** @type {string} */ a, /** @type {string} */ b) => {
          const [low = 0, high = 0] = [luminance(a), luminance(b)].sort((p, q) => p - q);
          return (high + 0.05) / (low + 0.05);
        };
        const behind = (/** @type {Element | null} */ element) => {
          for (let at = element; at; at = at.parentElement) {
            const { backgroundColor } = getComputedStyle(at);
            if (!/, 0\)$|transparent/.test(backgroundColor)) return backgroundColor;
          }
          return "white";
        };
        /** @type {string[]} */
        const found = places.filter((place) => !document.querySelector(place)).map((place) => `no ${place}`);
        for (const element of document.querySelectorAll(edges)) {
          const style = getComputedStyle(element);
          const edge = element.matches(".switch") ? style.backgroundColor : style.borderTopColor;
          const value = contrast(edge, behind(element.parentElement));
          if (!(/** @type {HTMLInputElement} */ (element).disabled) && value < 3) found.push(`${element.className} ${value.toFixed(2)}`);
        }
        for (const line of document.querySelectorAll(".chart-entry .stroke")) {
          const value = contrast(getComputedStyle(line).borderTopColor, behind(line.parentElement));
          if (value < 3) found.push(`line of a plot ${value.toFixed(2)}`);
        }
        // The track is a pseudo-element: its colour is asked for by an element that wears it.
        const probe = document.body.appendChild(document.createElement("i"));
        for (const name of ["--line-strong", "--accent"]) {
          probe.style.color = `var(${name})`;
          const value = contrast(getComputedStyle(probe).color, behind(document.querySelector(".side")));
          if (value < 3) found.push(`track ${name} ${value.toFixed(2)}`);
        }
        probe.remove();
        return [...new Set(found)];
      }, /** @type {const} */ ([PLACES, EDGES]));
      assert.deepEqual(low, [], dark ? "dark" : "light");
    }
  }));
