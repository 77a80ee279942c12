// The viewer in Chromium: a picture, an orbit, another algorithm. Leaves e2e-viewer.png in the build folder.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { PATIENCE_MS, binaryDir, playwright, serve, sleep } from "./support.mjs";

const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(executablePath)) {
  console.log(`${executablePath} is missing: skipped`);
  process.exit(77);
}
const server = await serve("--scene", "builtin:box");
const profile = mkdtempSync(join(tmpdir(), "gnomon-chromium-"));
const browser = await playwright().chromium.launchPersistentContext(profile, {
  executablePath,
  headless: true,
  viewport: { width: 1000, height: 600 },
  args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
const problems = [];
try {
  const page = browser.pages()[0] ?? (await browser.newPage());
  page.setDefaultTimeout(PATIENCE_MS);
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  await page.goto(server.url);
  // page.waitForFunction() evaluates strings, which the page's own policy forbids.
  const until = async (what, condition, argument) => {
    const end = Date.now() + PATIENCE_MS;
    while (!(await page.evaluate(condition, argument))) {
      assert.ok(Date.now() < end, `no ${what} within ${PATIENCE_MS} ms`);
      await sleep(30);
    }
  };
  const still = (after) => until(`still frame after ${after}`, (frame) => {
    const { still, frame: now } = document.getElementById("picture").dataset;
    return still === "true" && Number(now) > frame;
  }, after);
  const state = () => page.evaluate(() => {
    const canvas = document.getElementById("picture");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    let hash = 0;
    for (let i = 0; i < data.length; i += 4) {
      colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
      hash = (Math.imul(hash, 31) + data[i] + 3 * data[i + 1] + 7 * data[i + 2]) | 0;
    }
    return { width: canvas.width, height: canvas.height, colours: colours.size, hash, frame: Number(canvas.dataset.frame) };
  });

  await still(0);
  const first = await state();
  assert.deepEqual([first.width, first.height], [1000, 600]);
  assert.ok(first.colours > 500, `${first.colours} colours`);

  // Drag: the picture changes.
  await page.mouse.move(300, 300);
  await page.mouse.down();
  for (let i = 1; i <= 12; i++) await page.mouse.move(300 + 12 * i, 300 - 3 * i);
  await page.mouse.up();
  await still(first.frame);
  const turned = await state();
  assert.notEqual(turned.hash, first.hash, "dragging changes the picture");

  // Wheel.
  await page.mouse.wheel(0, -200);
  await still(turned.frame);
  const nearer = await state();
  assert.notEqual(nearer.hash, turned.hash, "the wheel changes the picture");

  // Another algorithm, by the panel made from server.hello.
  const options = await page.locator("#algorithm option").evaluateAll((all) => all.map((o) => o.value));
  const current = await page.locator("#algorithm").inputValue();
  const other = options.find((name) => name !== current);
  await page.locator("#algorithm").selectOption(other);
  await still(nearer.frame);
  const switched = await state();
  assert.notEqual(switched.hash, nearer.hash, `${current} -> ${other} changes the picture`);
  await page.locator("#algorithm").selectOption(current);
  await still(switched.frame);
  assert.equal((await state()).hash, nearer.hash, "and back again gives the same picture");

  await until("figures", () => /\d/.test(document.getElementById("render").textContent) && /\d/.test(document.getElementById("fps").textContent));
  assert.equal(await page.locator("#message").isHidden(), true);
  await page.screenshot({ path: join(binaryDir, "e2e-viewer.png") });
  assert.deepEqual(problems, []);

  // The server goes: the page says so.
  await server.stop();
  await until("word of the lost connection", () => /Connection lost/.test(document.getElementById("message").textContent));
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
  rmSync(profile, { recursive: true, force: true });
}
console.log("all good");
process.exit(0);
