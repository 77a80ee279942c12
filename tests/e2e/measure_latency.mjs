// Motion-to-photon in Chromium, as a person would see it: from the time stamp of an input event to the return of the draw call with the frame
// that echoes it, one input at a time, 1280 x 720, builtin:box, loopback. Prints medians and 95th percentiles of its parts.
//   sh tests/e2e/node.sh build/release measure_latency.mjs [INPUTS [SCENE [CODEC]]]
import { openBrowser, still, until } from "./chromium.mjs";
import { serve, sleep } from "./support.mjs";

const inputs = Number(process.argv[2] ?? 60), scene = process.argv[3] ?? "builtin:box", codec = process.argv[4];
const server = await serve("--scene", scene, "--scenes", process.env.SCENES ?? ".");
const browser = await openBrowser({ viewport: { width: 1280, height: 720 } });
const { page } = browser;
const answered = (count) => until(page, `answer to input ${count}`, (n) => window.measured.length >= n, count);
try {
  await page.goto(server.url);
  await still(page, 0);
  await page.evaluate(() => {
    window.measured = [];
    document.getElementById("picture").addEventListener("gnomon:frame", ({ detail }) => detail.photonMs !== null && window.measured.push(detail));
  });
  if (codec) await page.locator('[data-control="codec"] select').selectOption(codec);
  await page.keyboard.press("p"); // without the panel the stage is the window
  await until(page, "1280 x 720", () => document.getElementById("picture").width === 1280);
  await page.mouse.move(400, 300);
  await page.mouse.down();
  await sleep(600);
  const first = await page.evaluate(() => window.measured.length);
  for (let i = 0; i < inputs; i++) {
    await page.mouse.move(401 + i * 3, 300 + (i % 7));
    await answered(first + i + 1);
    await sleep(300 + (i * 7) % 17); // past the still frame, and out of step with the screen's refresh
  }
  const measured = (await page.evaluate(() => window.measured)).slice(first);
  const at = (values, part) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(values.length * part))];
  const row = (name, of) => {
    const values = measured.map(of);
    console.log(`${name.padEnd(34)} ${at(values, 0.5).toFixed(2).padStart(8)} ${at(values, 0.95).toFixed(2).padStart(8)}`);
    return [at(values, 0.5), at(values, 0.95)];
  };
  const own = (t) => t.renderMs + t.encodeMs + t.decodeMs;
  console.log(`${scene}, ${measured.length} inputs, ${measured[0].width} x ${measured[0].height}, ${(at(measured.map((t) => t.bytes), 0.5) / 1024).toFixed(0)} KiB a frame; ms`);
  console.log(`${"".padEnd(34)} ${"median".padStart(8)} ${"95 %".padStart(8)}`);
  const [photon, late] = row("motion to photon", (t) => t.photonMs);
  row("  event to message sent", (t) => t.inputMs);
  row("  render (server)", (t) => t.renderMs);
  row("  encode (server)", (t) => t.encodeMs);
  row("  transfer and waiting", (t) => t.transferMs);
  row("  decode (client)", (t) => t.decodeMs);
  row("  draw (client)", (t) => t.drawMs);
  const [rest] = row("all but render, encode, decode", (t) => t.photonMs - own(t));
  console.log(`targets: rest at most 12 ms at the median: ${rest <= 12 ? "met" : "missed"}; 95 % at most twice the median: ${late <= 2 * photon ? "met" : "missed"} (${(late / photon).toFixed(2)})`);
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
process.exit(0);
