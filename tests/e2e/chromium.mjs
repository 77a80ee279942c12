// Chromium for the scripts of this folder: its flags, and what they ask of the viewer's page.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { PATIENCE_MS, playwright, sleep } from "./support.mjs";

const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync"];

// Ends the script with 77 where there is no Chromium.
export async function openBrowser(options = {}) {
  if (!existsSync(executablePath)) {
    console.log(`${executablePath} is missing: skipped`);
    process.exit(77);
  }
  const profile = mkdtempSync(join(tmpdir(), "gnomon-chromium-"));
  const context = await playwright().chromium.launchPersistentContext(profile, {
    executablePath, headless: true, viewport: { width: 1280, height: 800 }, args: FLAGS, colorScheme: "dark", ...options,
  });
  return {
    context,
    page: context.pages()[0] ?? (await context.newPage()),
    async close() {
      await context.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

// A list that gets what the page throws and what its console calls an error.
export function watchProblems(page) {
  const problems = [];
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  return problems;
}

// What a page is asked, again and again until it is so. page.waitForFunction() evaluates strings, which the page's own policy forbids.
export async function until(page, what, condition, argument) {
  const end = Date.now() + PATIENCE_MS;
  while (!(await page.evaluate(condition, argument))) {
    assert.ok(Date.now() < end, `no ${what} within ${PATIENCE_MS} ms`);
    await sleep(30);
  }
}

// A still frame later than frame `after` of the view that is open.
export const still = (page, after) => until(page, `still frame after ${after}`, (frame) => {
  const { still, frame: now } = document.getElementById("picture").dataset;
  return still === "true" && Number(now) > frame;
}, after);

// Presses Cancel as soon as there is something to cancel, quicker than a person could: what goes on must not be over by then.
export const cancel = (page) => until(page, "way to cancel", () => {
  const button = document.querySelector("#message .cancel");
  const there = !button.hidden && !document.getElementById("message").hidden;
  if (there) button.click();
  return there;
});

// The canvas: its size, how many colours, a sum that tells pictures apart, mean brightness.
export const state = (page) => page.evaluate(() => {
  const canvas = document.getElementById("picture");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const colours = new Set();
  let hash = 0, sum = 0;
  for (let i = 0; i < data.length; i += 4) {
    colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    hash = (Math.imul(hash, 31) + data[i] + 3 * data[i + 1] + 7 * data[i + 2]) | 0;
    sum += data[i] + data[i + 1] + data[i + 2];
  }
  return { width: canvas.width, height: canvas.height, colours: colours.size, hash, mean: sum / (data.length * 0.75), frame: Number(canvas.dataset.frame) };
});
