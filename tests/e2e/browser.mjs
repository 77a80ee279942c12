// The viewer in Chromium: what a person does with it. Leaves viewer-*.png in the build folder.
import assert from "node:assert/strict";
import { join } from "node:path";
import { openBrowser, state, still, until, watchProblems } from "./chromium.mjs";
import { PATIENCE_MS, binaryDir, serve, sleep } from "./support.mjs";

let server = await serve("--scene", "builtin:box");
const browser = await openBrowser();
const { page } = browser;
const problems = watchProblems(page);
const control = (name, inner) => page.locator(`[data-control="${name}"] ${inner}`);
const shot = (name) => page.screenshot({ path: join(binaryDir, `viewer-${name}.png`) });
const changed = async (before, what) => {
  await still(page, before.frame);
  const after = await state(page);
  assert.notEqual(after.hash, before.hash, what);
  return after;
};
const drag = async (from, by) => {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) await page.mouse.move(from.x + (by.x * i) / 10, from.y + (by.y * i) / 10);
  await page.mouse.up();
};
const boxOf = async (locator) => {
  const { x, y, width, height } = await locator.boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
};

try {
  page.setDefaultTimeout(PATIENCE_MS);
  await page.goto(server.url);

  // Loads, sharp: as many pixels as the stage has.
  await still(page, 0);
  let now = await state(page);
  const stage = await page.locator("#stage").boundingBox();
  assert.deepEqual([now.width, now.height], [stage.width, stage.height]);
  assert.ok(now.colours > 500, `${now.colours} colours`);

  // Hands: drag, wheel, keys, and home again.
  const home = now;
  await drag({ x: 300, y: 300 }, { x: 140, y: -30 });
  now = await changed(now, "dragging turns the picture");
  await page.mouse.wheel(0, -200);
  now = await changed(now, "the wheel zooms");
  await page.locator("#picture").focus();
  await page.keyboard.press("ArrowLeft");
  now = await changed(now, "arrow keys turn the picture");
  await page.keyboard.press("Shift+ArrowUp");
  now = await changed(now, "with Shift they pan");
  await page.keyboard.press("h");
  now = await changed(now, "h goes home");
  assert.equal(now.hash, home.hash, "home is where it began");

  // Controls made from server.hello: another system and back, a parameter, what is shown.
  const system = control("algorithm", "select");
  const titles = await system.locator("option").allTextContents();
  assert.ok(titles.length >= 2, "several shadow systems");
  const current = await system.evaluate((select) => select.selectedIndex);
  await system.selectOption({ index: (current + 1) % titles.length });
  now = await changed(now, "another system is another picture");
  await system.selectOption({ index: current });
  now = await changed(now, "and back");
  assert.equal(now.hash, home.hash, "the same picture again");
  assert.match(await control("param-size", "input").getAttribute("title"), /texel|side/i, "help as a tooltip");
  await control("param-size", "input").fill("64");
  await control("param-size", "input").press("Enter");
  now = await changed(now, "a coarse shadow map shows");

  // What the server refuses is said in its own words, and the field goes back.
  await control("param-size", "input").fill("-5");
  await control("param-size", "input").press("Enter");
  await page.locator("#message.bad").waitFor();
  assert.match(await page.locator("#message").textContent(), /size/);
  await page.locator("#message .dismiss").click();
  assert.equal(await page.locator("#message").isHidden(), true);
  await page.locator("#picture").focus();
  await control("show", "select").selectOption("visibility");
  now = await changed(now, "visibility is another picture");
  await control("show", "select").selectOption("shaded");
  now = await changed(now, "shaded again");

  // Lights: one more, moved by its handle and by numbers, removed.
  const before = now;
  await page.getByText("Add a light").click();
  await control("add-spot", "button").click();
  now = await changed(now, "a light more");
  const handle = page.locator('.handle.place[data-light="1"]');
  const from = await boxOf(handle);
  await drag(from, { x: -120, y: 25 });
  now = await changed(now, "dragging its handle moves the light");
  const to = await boxOf(handle);
  assert.ok(Math.hypot(to.x - from.x + 120, to.y - from.y - 25) < 3, `the handle follows the hand: ${JSON.stringify([from, to])}`);
  await handle.focus();
  await page.keyboard.press("ArrowRight");
  now = await changed(now, "arrow keys move it too");
  const light = page.locator(".lil-gui[data-light='1']");
  if (await light.evaluate((folder) => folder.classList.contains("lil-closed"))) await light.locator(".lil-title").click();
  await control("light-1-intensity", "input").fill("2000");
  await control("light-1-intensity", "input").press("Enter");
  now = await changed(now, "a number changes it");
  await control("light-1-color", "input[type=text]").fill("#ff4020");
  await control("light-1-color", "input[type=text]").press("Enter");
  now = await changed(now, "so does a colour");
  await shot("1280x800");
  await control("light-1-remove", "button").click();
  now = await changed(now, "a light less");
  assert.equal(now.hash, before.hash, "as before it came");

  // A light outside the picture is shown at its edge, and comes in when it is dragged.
  const outside = page.locator('.handle.outside[data-light="0"]');
  const edge = await boxOf(outside);
  await drag(edge, { x: -150, y: 80 });
  now = await changed(now, "the light that was outside moves");
  const inside = await boxOf(page.locator('.handle.place[data-light="0"]'));
  assert.ok(Math.hypot(inside.x - edge.x + 150, inside.y - edge.y - 80) < 3, `it stays under the hand: ${JSON.stringify([edge, inside])}`);

  // A picture to keep.
  const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Escape").then(() => page.locator("#save").click())]);
  assert.match(download.suggestedFilename(), /^gnomon-box-sm.*\.png$/);

  // Figures and charts.
  await until(page, "figures", () => ["render", "encode", "decode", "latency", "rtt"].every((id) => /\d/.test(document.getElementById(id).textContent)));
  await until(page, "charts", () => document.querySelectorAll(".uplot canvas").length === 2);

  // Help, and its way out.
  await page.locator("#picture").focus();
  await page.keyboard.press("?");
  assert.equal(await page.locator("#help").evaluate((dialog) => dialog.open), true);
  await shot("help");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#help").evaluate((dialog) => dialog.open), false);

  // Dark, light, and as the system has it.
  const ground = () => page.evaluate(() => [document.documentElement.dataset.theme, getComputedStyle(document.body).backgroundColor]);
  const dark = await ground();
  assert.equal(dark[0], "dark");
  await page.emulateMedia({ colorScheme: "light" });
  await until(page, "light colours", () => document.documentElement.dataset.theme === "light");
  assert.notEqual((await ground())[1], dark[1]);
  await page.locator("#theme").click();
  assert.equal((await ground())[0], "dark", "the switch wins over the system");
  await page.locator("#theme").click();
  assert.equal((await ground())[0], "light");
  await shot("light");

  // Narrow windows: nothing sticks out, the picture fits what it is given.
  for (const [width, height] of [[700, 800], [700, 500], [390, 844]]) {
    await page.setViewportSize({ width, height });
    await until(page, `a picture for ${width} x ${height}`, () => {
      const canvas = document.getElementById("picture");
      return canvas.width === canvas.clientWidth && canvas.height === canvas.clientHeight && canvas.dataset.still === "true";
    });
    const layout = await page.evaluate(() => {
      const rect = (id) => document.getElementById(id).getBoundingClientRect();
      const inside = (r) => r.left >= -1 && r.top >= -1 && r.right <= innerWidth + 1 && r.bottom <= innerHeight + 1;
      return { scrolls: document.documentElement.scrollWidth > innerWidth, inside: ["stage", "side", "tools", "toggle"].map((id) => inside(rect(id))), picture: rect("picture").width * rect("picture").height };
    });
    assert.deepEqual([layout.scrolls, layout.inside], [false, [true, true, true, true]], `${width} x ${height}`);
    assert.ok(layout.picture > 0.4 * width * height, `${width} x ${height}: the picture keeps ${layout.picture} pixels`);
    await shot(`${width}x${height}`);
  }
  await page.keyboard.press("p");
  await until(page, "the panel's going", () => document.getElementById("side").offsetParent === null);
  await page.keyboard.press("p");
  await page.setViewportSize({ width: 1280, height: 800 });
  await until(page, "the old size", (width) => document.getElementById("picture").width === width, stage.width);
  assert.deepEqual(problems, []);

  // The server goes: the page says so. It comes back on the same port: so does the view, as it was.
  await still(page, 0);
  await drag({ x: 300, y: 300 }, { x: -60, y: 10 });
  await sleep(500);
  await still(page, 0);
  const lost = await state(page);
  await server.stop();
  await until(page, "word of the lost connection", () => /Connection lost/.test(document.getElementById("status").textContent));
  assert.equal((await state(page)).hash, lost.hash, "the last picture stays");
  server = await serve("--listen", new URL(server.url).host, "--scene", "builtin:ball");
  await until(page, "the connection", () => document.getElementById("status").dataset.state === "open");
  await still(page, 0);
  assert.equal((await state(page)).hash, lost.hash, "the same scene, camera and system as before");
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
console.log("all good");
process.exit(0);
