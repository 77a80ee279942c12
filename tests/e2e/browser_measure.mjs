// The viewer's comparisons, pictures to keep and things to share: measured, cancelled, saved at a size of their own, copied, and the same again from
// the copies.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { cancel, openBrowser, state, still, until, watchProblems } from "./chromium.mjs";
import { PATIENCE_MS, serve } from "./support.mjs";

const folder = mkdtempSync(join(tmpdir(), "gnomon-e2e-"));
const server = await serve("--scene", "builtin:tree");
const browser = await openBrowser({ viewport: { width: 900, height: 420 }, acceptDownloads: true });
const { page, context } = browser;
const problems = watchProblems(page);
const control = (name, inner) => page.locator(`[data-control="${name}"] ${inner}`);
const copied = async (name) => {
  await page.evaluate(() => navigator.clipboard.writeText(""));
  await control(name, "button").evaluate((button) => button.click());
  await until(page, "text on the clipboard", () => navigator.clipboard.readText());
  return page.evaluate(() => navigator.clipboard.readText());
};
// As a shell would, with the program that is tested.
const run = (command) => execFileSync("sh", ["-c", command.replace(/^gnomon /, `${resolve(process.env.GNOMON)} `)], { cwd: folder, stdio: ["ignore", "pipe", "ignore"] });
const download = async (act) => {
  const [file] = await Promise.all([page.waitForEvent("download"), act()]);
  return readFileSync(await file.path());
};
// How many pixels of two PNG files differ; files of the command line also tell how they were made.
const differing = (a, b) => page.evaluate(async (files) => {
  const [one, two] = await Promise.all(files.map(async (text) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    context.drawImage(picture, 0, 0);
    return new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer);
  }));
  return one.length === two.length ? one.filter((pixel, i) => pixel !== two[i]).length : Infinity;
}, [a, b].map((file) => file.toString("base64")));
const figure = (name) => page.locator(`[data-figure="${name}"] td`).first().textContent();
const running = () => page.locator('[data-control="compare-run"]').getAttribute("data-running");

try {
  page.setDefaultTimeout(PATIENCE_MS);
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.goto(server.url);
  await still(page, 0);
  const { frame } = await state(page);
  await page.mouse.move(200, 200);
  await page.mouse.down();
  await page.mouse.move(290, 190, { steps: 4 });
  await page.mouse.up();
  await still(page, frame);

  // A comparison: figures, a difference picture over the view, gone with the next movement.
  await page.locator("#picture").focus();
  await page.keyboard.press("m");
  await until(page, "figures", () => !document.querySelector(".compared").hidden);
  const local = JSON.parse(run(`${await copied("share-compare")} --quiet`));
  assert.ok((await figure("misclassified")).startsWith(local.misclassified.toLocaleString("en")), `${await figure("misclassified")}, the command line says ${local.misclassified}`);
  assert.ok(local.misclassified > 0);
  assert.equal(Number(await figure("rmse")), Number(local.rmse.toPrecision(3)));
  await until(page, "the difference picture", () => !document.getElementById("difference").hidden);
  const orange = await page.evaluate(() => {
    const canvas = document.querySelector("#difference canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) count += data[i] > data[i + 2] + 60 ? 1 : 0;
    return [canvas.width, canvas.height, count];
  });
  assert.deepEqual(orange.slice(0, 2), [(await state(page)).width, (await state(page)).height]);
  assert.ok(orange[2] > 0, "leaks are orange");
  await page.keyboard.press("ArrowLeft");
  await until(page, "the picture below again", () => document.getElementById("difference").hidden);
  assert.ok(await page.locator(".compared").evaluate((table) => table.classList.contains("stale")), "the figures are of another view");

  // One that takes long is given up: no error, no new figures, and the next is served.
  await control("compare-against", "select").selectOption({ label: "ray traced, 32 samples" });
  await page.locator("#picture").focus();
  await page.keyboard.press("m");
  await until(page, "a way to cancel", () => /^Cancel/.test(document.querySelector('[data-control="compare-run"] button').textContent));
  assert.equal(await running(), "true");
  await page.keyboard.press("m");
  assert.equal(await running(), "false");
  assert.equal(await page.locator("#message.bad").count(), 0);
  assert.ok(await page.locator(".compared").evaluate((table) => table.classList.contains("stale")));
  await control("compare-against", "select").selectOption({ label: "Shadow map" });
  await control("algorithm", "select").selectOption({ label: "No shadows" });
  await still(page, (await state(page)).frame);
  await control("compare-live", "input").check();
  await until(page, "figures of the other pair", () => document.querySelector(".compared thead th:nth-child(2)").textContent === "none" && !document.querySelector(".compared").classList.contains("stale"));
  await control("compare-live", "input").uncheck();

  // A picture at its own size, of every format; the command that was copied makes the same one.
  await page.setViewportSize({ width: 645, height: 201 });
  await until(page, "a small picture", () => document.getElementById("picture").width === document.getElementById("picture").clientWidth && document.getElementById("picture").dataset.still === "true");
  const now = await state(page);
  for (const side of ["width", "height"]) await control(`snapshot-${side}`, "input").evaluate((input, value) => {
    input.value = value;
    input.dispatchEvent(new Event("input"));
  }, String(now[side]));
  const choose = (name, value) => control(name, "select").evaluate((select, text) => {
    select.selectedIndex = [...select.options].findIndex((option) => option.textContent === text);
    select.dispatchEvent(new Event("change"));
  }, value);
  await choose("snapshot-aa", "1");
  const taken = {};
  for (const [format, magic] of [["jpeg", "ffd8ff"], ["webp", "52494646"], ["exr", "762f3101"], ["png", "89504e47"]]) {
    await choose("snapshot-format", format);
    taken[format] = await download(() => control("snapshot-save", "button").evaluate((button) => button.click()));
    assert.equal(taken[format].subarray(0, magic.length / 2).toString("hex"), magic, format);
  }
  assert.deepEqual([taken.png.readUInt32BE(16), taken.png.readUInt32BE(20)], [now.width, now.height], "its own size");
  const command = await copied("share-render");
  run(`${command} --quiet`);
  assert.equal(await differing(readFileSync(join(folder, "tree.png")), taken.png), 0, `the same picture: ${command}`);
  assert.ok((await differing(taken.png, Buffer.from(await page.screenshot({ clip: { x: 0, y: 0, width: now.width, height: now.height } })))) > 0, "and not any");
  run(`${(await copied("share-curl")).replace("tree.png", "curl.png")} -s`);
  assert.ok(readFileSync(join(folder, "curl.png")).equals(taken.png), "and over HTTP");

  // A picture that takes long is given up.
  await control("snapshot-width", "input").evaluate((input) => {
    input.value = "8000";
    input.dispatchEvent(new Event("input"));
  });
  await control("snapshot-save", "button").evaluate((button) => button.click());
  await cancel(page);
  await until(page, "word of it", () => /was cancelled/.test(document.getElementById("message").textContent));

  // The address shows the same elsewhere: camera, lights, system.
  await control("light-0-intensity", "input").evaluate((input) => {
    input.value = "150";
    input.dispatchEvent(new Event("input"));
  });
  await still(page, now.frame);
  const link = await copied("share-link");
  assert.match(link, /eye=[-\d.,]+&target=[-\d.,]+&fov=[\d.]+&light=point/);
  const here = await state(page);
  const other = await context.newPage();
  await other.setViewportSize(page.viewportSize());
  await other.goto(link);
  await still(other, 0);
  assert.equal((await state(other)).hash, here.hash, "the same picture from the link");
  await other.close();
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
console.log("all good");
process.exit(0);
