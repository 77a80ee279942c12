// The viewer on other screens and hands: sharp at two device pixels a CSS pixel, fingers, a mouse faster than the frames.
import assert from "node:assert/strict";
import { openBrowser, state, still, until, watchProblems } from "./chromium.mjs";
import { PATIENCE_MS, serve, sleep } from "./support.mjs";

const server = await serve("--scene", "builtin:box");
const browser = await openBrowser({ viewport: { width: 390, height: 700 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true });
const { page, context } = browser;
const problems = watchProblems(page);
try {
  page.setDefaultTimeout(PATIENCE_MS);
  // A link holds scene, system and what is shown.
  await page.goto(`${server.url}#scene=builtin:box&show=normal`);
  await still(page, 0);
  const first = await state(page);
  const stage = await page.locator("#stage").boundingBox();
  assert.equal(first.width, 2 * 390, "device pixels, not CSS pixels");
  assert.ok(Math.abs(first.height - 2 * stage.height) <= 2, `${first.height} for ${stage.height}`);
  assert.equal(await page.locator('[data-control="show"] select').evaluate((select) => select.selectedOptions[0].textContent), "normal");

  // One finger turns, two zoom.
  const session = await context.newCDPSession(page);
  const touch = (type, ...points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  await touch("touchStart", [150, 200]);
  for (let i = 1; i <= 8; i++) await touch("touchMove", [150 + 10 * i, 200 + 2 * i]);
  await touch("touchEnd");
  await still(page, first.frame);
  const turned = await state(page);
  assert.notEqual(turned.hash, first.hash, "a finger turns the picture");
  await touch("touchStart", [150, 200], [240, 200]);
  for (let i = 1; i <= 8; i++) await touch("touchMove", [150 - 8 * i, 200], [240 + 8 * i, 200]);
  await touch("touchEnd");
  await still(page, turned.frame);
  const nearer = await state(page);
  assert.notEqual(nearer.hash, turned.hash, "two fingers zoom");
  assert.equal(await page.evaluate(() => visualViewport.scale), 1, "the page itself stays as it is");

  // Frames that are late: the last one follows the hand meanwhile, and ends straight.
  await page.locator('[data-control="show"] select').selectOption("shaded");
  await page.locator('[data-control="algorithm"] select').selectOption({ label: (await page.locator('[data-control="algorithm"] option').allTextContents()).at(-1) });
  await still(page, 0);
  await page.evaluate(() => {
    const canvas = document.getElementById("picture");
    window.bends = window.late = 0;
    canvas.addEventListener("gnomon:frame", ({ detail }) => (window.late += detail.renderMs > 100 ? 1 : 0));
    new MutationObserver(() => (window.bends += canvas.style.transform.startsWith("matrix3d") ? 1 : 0)).observe(canvas, { attributes: true, attributeFilter: ["style"] });
  });
  const { frame } = await state(page);
  await page.mouse.move(150, 150);
  await page.mouse.down();
  for (let i = 1; i <= 40; i++) {
    await page.mouse.move(150 + 2 * i, 150 + i);
    await sleep(10);
  }
  await page.mouse.up();
  await still(page, frame);
  const { bends, late, transform } = await page.evaluate(() => ({ bends: window.bends, late: window.late, transform: document.getElementById("picture").style.transform }));
  console.log(`${bends} bends over ${(await state(page)).frame - frame} frames`);
  assert.ok(bends > 0 || late === 0, "late frames are bent");
  assert.equal(transform, "", "a still picture is straight");
  await until(page, "a picture as large as its canvas", () => document.getElementById("picture").width === 2 * 390);
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
console.log("all good");
process.exit(0);
