/** Draws docs/viewer.png, the picture of the README: an arm with meshes, its ellipsoid and screws. */
import { writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { smallPng } from "./png.mjs";
import { launch, open, ROBOTS, serve, showOverlay } from "./lib.mjs";

const [WIDTH, HEIGHT] = [1280, 720];
const OUT = fileURLToPath(new URL("../../docs/viewer.png", import.meta.url));
const q = "0,-0.4,0,-1.9,0,1.6,0.785,0.02";
const server = await serve(`${ROBOTS}/panda_description/urdf/panda.urdf`, `--q=${q}`);
const browser = await launch();
try {
  const { page, close } = await open(browser, `${server.url}?quality=high`, { width: WIDTH, height: HEIGHT });
  for (const name of ["velocity-ellipsoid", "active-force-ellipsoid"]) await showOverlay(page, name);
  await page.waitForLoadState("networkidle");
  await page.waitForTimeout(3000); // the last meshes are drawn
  await page.locator(".side.left").evaluate((side) => side.scrollTo(0, 0));
  await writeFile(OUT, smallPng(await pixels(page, await page.screenshot()), WIDTH, HEIGHT));
  await close();
} finally {
  await browser.close();
  await server.stop();
}

/**
 * The pixels of a picture, four bytes each.
 * @param {import("playwright-core").Page} page
 * @param {Buffer} png
 */
async function pixels(page, png) {
  const text = await page.evaluate(async (given) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(given), (byte) => byte.charCodeAt(0))]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    if (!context) throw new Error("no canvas");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let bytes = "";
    for (let i = 0; i < data.length; i += 8192) bytes += String.fromCharCode(...data.subarray(i, i + 8192));
    return btoa(bytes);
  }, png.toString("base64"));
  return Buffer.from(text, "base64");
}
