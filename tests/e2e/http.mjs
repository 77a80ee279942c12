// HTTP: pages, health, metrics, pictures, and who is let in.
import assert from "node:assert/strict";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { spawnSync } from "node:child_process";
import { http, serve, upgrade } from "./support.mjs";

const folder = mkdtempSync(join(tmpdir(), "gnomon-e2e-"));
const post = (server, body, headers) => http(`${server.url}v1/render`, { method: "POST", headers, body: typeof body === "string" ? body : JSON.stringify(body) });

const open = await serve();
for (const [path, status, type] of [["", 200, /html/], ["app.js", 200, /javascript/], ["style.css", 200, /css/], ["healthz", 200, /plain/], ["readyz", 200, /plain/],
  ["metrics", 200, /plain/], ["nonesuch", 404, /plain/], ["../../etc/passwd", 404, /plain/], ["v1/render", 405, /plain/]]) {
  const answer = await http(open.url + path);
  assert.equal(answer.status, status, path);
  assert.match(answer.headers["content-type"], type);
}
const metrics = (await http(`${open.url}metrics`)).body.toString();
for (const name of ['gnomon_frames_rendered_total{algorithm=', 'gnomon_frames_sent_total{codec="jpeg"}', "gnomon_frames_dropped_total{reason=", "gnomon_clients 0",
  'gnomon_frame_seconds_bucket{le="+Inf"}', "gnomon_frame_seconds_sum", "gnomon_frame_seconds_count"])
  assert.ok(metrics.includes(name), name);

// Pictures: each format by its first bytes, the same request the same bytes.
for (const [format, magic, type] of [["png", "89504e47", "image/png"], ["jpeg", "ffd8ff", "image/jpeg"], ["webp", "52494646", "image/webp"], ["exr", "762f3101", "image/x-exr"]]) {
  const answer = await post(open, { scene: "builtin:box", size: [160, 90], format });
  assert.equal(answer.status, 200, answer.body.toString());
  assert.equal(answer.headers["content-type"], type);
  assert.equal(answer.body.subarray(0, magic.length / 2).toString("hex"), magic);
}
const request = { scene: "builtin:box", size: [160, 90], camera: { eye: [4, 3, 5], target: [0, 0, 0], fov: 40 } };
const png = (await post(open, request)).body;
assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [160, 90]);
assert.ok(png.equals((await post(open, request)).body), "the same request, the same picture");
assert.ok(!png.equals((await post(open, { ...request, lights: [{ kind: "point", position: [0, 3, 0], intensity: 80 }] })).body));

// What is refused, and the name of what is wrong.
for (const [body, status, text] of [
  [{ scene: "builtin:box", sise: [1, 1], other: 1 }, 400, /sise, other/], [{ size: [0, 1] }, 400, /size/], [{ size: [20000, 1] }, 400, /16384/], [{ size: [1.5, 2] }, 400, /whole/],
  [{ scene: 5 }, 400, /scene/], [{ scene: "nonesuch.gltf" }, 404, /nonesuch/], [{ scene: "/etc/passwd" }, 404, /passwd/], [{ scene: "builtin:nonesuch" }, 404, /nonesuch/],
  [{ camera: { eye: [1, 2, 3] } }, 400, /camera.target/], [{ camera: { eye: [1, 2, 3], target: [1, 2, 3] } }, 400, /eye|target/], [{ camera: "nonesuch" }, 400, /camera/],
  [{ lights: [{ kind: "lamp" }] }, 400, /kind/], [{ lights: [{ kind: "point", watts: 3 }] }, 400, /watts/], [{ format: "gif" }, 400, /format/], [{ quality: 101 }, 400, /1 to 100/],
  [{ algorithm: "nonesuch" }, 400, /nonesuch/], [{ algorithm: "sm:size=1" }, 400, /16 to 16384/], [{ deadline_ms: 0 }, 400, /deadline_ms/], ["{", 400, /JSON/], ["[]", 400, /object/], ["", 400, /JSON/],
]) {
  const answer = await post(open, body);
  assert.equal(answer.status, status, `${JSON.stringify(body)}: ${answer.body}`);
  assert.match(JSON.parse(answer.body.toString()).error.message, text);
}
assert.equal(JSON.parse((await post(open, { algorithm: "sm:size=1" })).body).error.data.field, "algorithm.size", "not the request's own size");
assert.equal((await post(open, `"${"x".repeat(2 << 20)}"`)).status, 413);

// Host and Origin, before any upgrade.
assert.equal((await http(open.url, { headers: { host: "evil.example" } })).status, 403);
assert.equal((await http(open.url, { headers: { origin: "http://evil.example" } })).status, 403);
assert.equal((await http(open.url, { headers: { origin: open.url.slice(0, -1) } })).status, 200);
assert.equal(await upgrade(open.wsUrl), 101);
assert.equal(await upgrade(open.wsUrl, { headers: { origin: "http://evil.example" } }), 403);
assert.equal(await upgrade(open.wsUrl, { headers: { host: "evil.example" } }), 403);
assert.equal(await upgrade(`${open.url.replace("http", "ws")}other`), 404);
assert.notEqual(await upgrade(open.wsUrl, { protocol: "" }), 101);
const opened = await open.stop("SIGINT");
assert.equal(opened.code, 0, opened.err);

// Tokens.
const tokens = join(folder, "tokens");
writeFileSync(tokens, "# two\nview looker\n\ncontrol driver\n");
const closed = await serve("--token-file", tokens, "--allow-origin", "https://pages.example");
const bearer = (token) => ({ authorization: `Bearer ${token}` });
for (const path of ["", "metrics", "nonesuch"]) assert.equal((await http(closed.url + path)).status, 401, path);
assert.equal((await http(`${closed.url}healthz`)).status, 200);
assert.equal((await http(`${closed.url}?token=looker`)).status, 200);
assert.equal((await http(`${closed.url}?token=looke`)).status, 401);
assert.equal((await http(`${closed.url}metrics`, { headers: bearer("driver") })).status, 200);
assert.equal((await post(closed, { size: [8, 8] })).status, 401);
assert.equal((await post(closed, { size: [8, 8] }, bearer("looker"))).status, 200);
assert.equal(await upgrade(closed.wsUrl), 401);
assert.equal(await upgrade(closed.wsUrl, { headers: bearer("wrong") }), 401);
assert.equal(await upgrade(closed.wsUrl, { headers: bearer("looker") }), 101);
assert.equal(await upgrade(`${closed.wsUrl}?token=driver`, { headers: { origin: "https://pages.example" } }), 101);
const cross = await http(`${closed.url}metrics`, { headers: { ...bearer("driver"), origin: "https://pages.example" } });
assert.equal(cross.headers["access-control-allow-origin"], "https://pages.example");
assert.equal((await closed.stop()).code, 0);

// A network address wants tokens; a port in use is said.
const run = (...args) => spawnSync(process.env.GNOMON, ["serve", ...args], { encoding: "utf8", timeout: 20000 });
const bare = run("--listen", "0.0.0.0:0");
assert.deepEqual([bare.status, bare.stdout], [64, ""]);
assert.match(bare.stderr, /^gnomon: error: .*--token-file.*\n$/);
assert.equal(run("--listen", "127.0.0.1:0", "--scene", "/nonesuch.gltf").status, 66);
assert.equal(run("--listen", "127.0.0.1:0", "--token-file", join(folder, "none")).status, 66);
const holder = await serve();
assert.equal(run("--listen", new URL(holder.url).host).status, 74);
await holder.stop();
console.log("all good");
process.exit(0);
