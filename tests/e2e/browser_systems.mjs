// The viewer with every shadow system that the server has: its controls are those that server.hello describes, and each does what it says.
import assert from "node:assert/strict";
import { openBrowser, state, still, until, watchProblems } from "./chromium.mjs";
import { Client, PATIENCE_MS, WebSocket, inbox, serve } from "./support.mjs";

const server = await serve("--scene", "builtin:box");
const hellos = inbox();
const client = new Client(server.wsUrl, { hello: (hello) => hellos.push(hello) }, WebSocket);
const { algorithms } = await hellos.next("hello");
client.close();

const browser = await openBrowser({ viewport: { width: 700, height: 300 } });
const { page, context } = browser;
const problems = watchProblems(page);
const settings = () => page.evaluate(() => new URLSearchParams(location.hash.slice(1)).get("algorithm"));

// Another value that the description allows.
function another({ kind, min, max, default: own, choices, odd }) {
  if (kind === "choice") return choices.find((c) => c !== own);
  const step = kind === "int" ? (odd ? 2 : 1) : 0.25;
  const up = own + step;
  return max === null || max === undefined || up <= max ? up : own - step >= (min ?? -Infinity) ? own - step : undefined;
}

try {
  page.setDefaultTimeout(PATIENCE_MS);
  await page.goto(server.url);
  await still(page, 0);
  const pictures = new Set();
  for (const { name, title, params } of algorithms) {
    await page.locator('[data-control="algorithm"] select').selectOption({ label: title });
    await until(page, name, (n) => document.querySelector('[data-control="algorithm"]').title.includes(`(${n};`), name);
    await still(page, (await state(page)).frame - 1);
    pictures.add((await state(page)).hash);
    const shown = await page.locator('[data-control^="param-"]').evaluateAll((all) => all.map((c) => [c.dataset.control.slice(6), c.title, c.textContent]));
    assert.deepEqual(shown.map(([control]) => control), params.map((p) => p.name), `${name}: a control for each parameter`);
    params.forEach((p, i) => {
      assert.ok(shown[i][1].includes(p.help) && shown[i][1].includes(`default ${p.default}`), `${name}.${p.name}: ${shown[i][1]}`);
      if (p.unit) assert.ok(shown[i][2].includes(`(${p.unit})`), `${name}.${p.name}: its unit`);
    });
    // One of each kind: what is sent is what was chosen, and is taken.
    for (const kind of ["choice", "int", "float"]) {
      const param = params.find((p) => p.kind === kind && another(p) !== undefined);
      if (!param) continue;
      const value = String(another(param));
      const field = page.locator(`[data-control="param-${param.name}"]`);
      if (kind === "choice") await field.locator("select").selectOption({ label: value });
      else {
        await field.locator("input").last().fill(value);
        await field.locator("input").last().press("Enter");
      }
      await until(page, `${name}:${param.name}=${value}`, (text) => decodeURIComponent(location.hash).includes(text), `${param.name}=${value}`);
      assert.ok((await settings()).startsWith(`${name}:`));
    }
    assert.equal(await page.locator("#message.bad").count(), 0, `${name}: ${await page.locator("#message").textContent()}`);
  }
  assert.ok(pictures.size > 1, "systems differ");

  // What a system tells of itself stands in the page, by its own names; here the words are put into the server's mouth.
  const other = await context.newPage();
  await other.routeWebSocket(/ws$/, (socket) => {
    const far = socket.connectToServer();
    far.onMessage((message) => {
      const said = typeof message === "string" && message.includes('"view.stats"') ? JSON.parse(message) : undefined;
      if (said) said.params.figures = { mean_nodes: 1.25, texels: 1048576, converged: null };
      socket.send(said ? JSON.stringify(said) : message);
    });
  });
  await other.goto(server.url);
  await still(other, 0);
  await until(other, "figures of the system's own", () => document.querySelectorAll("#own-figures dt").length > 0);
  assert.deepEqual(await other.locator("#own-figures > *").allTextContents(), ["mean nodes", "1.25", "texels", "1,048,576"]);
  assert.deepEqual(problems, []);
  console.log(`all good: ${algorithms.map((a) => a.name).join(", ")}`);
} finally {
  await browser.close();
  await server.stop().catch(() => undefined);
}
process.exit(0);
