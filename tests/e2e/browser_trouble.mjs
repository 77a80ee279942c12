// The viewer where things change under it: refused tokens, scenes that change on disk, loads given up, cameras without perspective.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { cancel, openBrowser, state, still, until, watchProblems } from "./chromium.mjs";
import { PATIENCE_MS, serve } from "./support.mjs";

const folder = mkdtempSync(join(tmpdir(), "gnomon-e2e-"));
const tokens = join(folder, "tokens"), scene = join(folder, "wall.gltf");
writeFileSync(tokens, "control first\n");

// A wall of two triangles, `width` wide, seen by a parallel camera.
function wall(width) {
  const bytes = Buffer.alloc(6 * 12);
  [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]].forEach(([x, y], i) => [x * width, y, 0].forEach((v, axis) => bytes.writeFloatLE(v, 12 * i + 4 * axis)));
  return JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0 }, { camera: 0, translation: [0, 0, 3] }],
    cameras: [{ name: "plan", type: "orthographic", orthographic: { xmag: 4, ymag: 2, znear: 0.1, zfar: 10 } }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 6, type: "VEC3", min: [-width, -1, 0], max: [width, 1, 0] }],
    bufferViews: [{ buffer: 0, byteLength: bytes.length }],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  });
}
writeFileSync(scene, wall(1));

let server = await serve("--scenes", folder, "--token-file", tokens);
const browser = await openBrowser({ viewport: { width: 700, height: 400 } });
const { page, context } = browser;
const problems = watchProblems(page);
// Columns of the picture's middle row that show the wall.
const columns = () => page.evaluate(() => {
  const canvas = document.getElementById("picture");
  const { data } = canvas.getContext("2d").getImageData(0, canvas.height >> 1, canvas.width, 1);
  const ground = data[0] + data[1] + data[2];
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += Math.abs(data[i] + data[i + 1] + data[i + 2] - ground) > 24 ? 1 : 0;
  return count;
});
const says = (text) => until(page, `the words ${text}`, (t) => document.body.innerText.includes(t), text);

try {
  page.setDefaultTimeout(PATIENCE_MS);
  await page.goto(`${server.url}?token=first#scene=wall.gltf`);
  await still(page, 0);

  // Without perspective, zoomed, turned and panned: still without, and by the factor of the wheel.
  const before = await columns();
  const { frame } = await state(page);
  await page.mouse.move(194, 200);
  await page.mouse.wheel(0, -200);
  await still(page, frame);
  const ratio = (await columns()) / before;
  assert.ok(Math.abs(ratio - Math.exp(0.3)) < 0.03, `${before} columns became ${ratio} times as many`);
  await until(page, "its height in the address", () => /ortho=[\d.]+/.test(location.hash));
  assert.ok(Math.abs(Number(/ortho=([\d.]+)/.exec(page.url())[1]) - 4 * Math.exp(-0.3)) < 1e-3, page.url());
  await page.locator("#picture").focus();
  await page.keyboard.press("ArrowLeft");
  await until(page, "the turned camera", () => !/eye=0,/.test(location.hash));
  assert.match(page.url(), /ortho=/);
  await page.keyboard.press("h");
  await until(page, "home", () => /camera=0/.test(location.hash));
  await still(page, (await state(page)).frame - 1);

  // The command to copy asks this server for the scene: its program knows the name.
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.keyboard.press("k");
  await until(page, "a command", () => navigator.clipboard.readText().then((text) => text.startsWith("gnomon render wall.gltf --server ")));
  const command = await page.evaluate(() => navigator.clipboard.readText());
  execFileSync("sh", ["-c", `${command.replace(/^gnomon/, resolve(process.env.GNOMON))} --quiet`], { cwd: folder, env: { ...process.env, GNOMON_TOKEN: "first" } });
  assert.equal(readFileSync(join(folder, "wall.png")).subarray(1, 4).toString(), "PNG");

  // The file changes: the view shows the new one, and says so.
  assert.equal(await columns(), before);
  writeFileSync(scene, wall(2));
  await says("has changed on disk");
  await still(page, 0);
  assert.ok(Math.abs((await columns()) / before - 2) < 0.05, "twice as wide");

  // A load is given up: the view that was there stays.
  const kept = await state(page);
  await page.evaluate(() => (location.hash = "#scene=builtin:dragon:triangles=1000000"));
  await cancel(page);
  await says("Loading was cancelled");
  await still(page, 0);
  assert.equal((await state(page)).hash, kept.hash);
  assert.deepEqual(problems, []);

  // Another server with other tokens: refused, in words, with a field for the new one.
  await server.stop();
  writeFileSync(tokens, "view second\n");
  server = await serve("--listen", new URL(server.url).host, "--scenes", folder, "--token-file", tokens);
  await until(page, "word of the refusal", () => /^Refused: .*token/.test(document.getElementById("status").textContent));
  await page.locator("#token input").fill("second");
  await page.locator("#token button").click();
  await still(page, 0);
  assert.match(page.url(), /token=second/);
  assert.equal(await page.locator("#status").getAttribute("data-state"), "open");
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
console.log("all good");
process.exit(0);
