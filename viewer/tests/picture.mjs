/** Draws docs/viewer.png, the picture of the README: an arm with meshes, its ellipsoid and screws. */
import { fileURLToPath } from "node:url";
import { launch, open, ROBOTS, serve, until } from "./lib.mjs";

const OUT = fileURLToPath(new URL("../../docs/viewer.png", import.meta.url));
const server = await serve(`${ROBOTS}/panda_description/urdf/panda.urdf`);
const browser = await launch();
try {
  const { page, close } = await open(browser, `${server.url}?quality=high`, { width: 1280, height: 720 });
  for (const name of ["velocity-ellipsoid", "principal-screws"]) {
    await page.locator(`[data-overlay="${name}"]`).check();
    await until(page, `state.overlays["${name}"] !== undefined`);
  }
  await page.waitForLoadState("networkidle");
  await page.waitForTimeout(3000); // the last meshes are drawn
  await page.locator(".side.left").evaluate((side) => side.scrollTo(0, 0));
  await page.screenshot({ path: OUT });
  await close();
} finally {
  await browser.close();
  await server.stop();
}
