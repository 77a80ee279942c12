// Requests that take a while: comparisons beside a stream, progress, giving up, pictures of every format at their own size.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { WebSocket, inbox, serve, within } from "./support.mjs";

const folder = mkdtempSync(join(tmpdir(), "gnomon-e2e-"));
writeFileSync(join(folder, "shed.gltf"), "{}");
const server = await serve("--scene", "builtin:box", "--size", "64x36", "--scenes", folder);

async function session() {
  const socket = new WebSocket(server.wsUrl, "gnomon.v1"), hello = inbox(), frames = inbox(), changes = inbox(), progress = [], answers = new Map();
  socket.on("message", (data, binary) => {
    if (binary) return void frames.push({ kind: data[6], codec: data[7], flags: data.readUInt16LE(8), view: data.readUInt32LE(12), frame: Number(data.readBigUInt64LE(16)), seq: data.readUInt32LE(32),
      width: data.readUInt16LE(36), height: data.readUInt16LE(38), id: data.readUInt32LE(48), reserved: data.subarray(52, 64), payload: data.subarray(64) });
    const message = JSON.parse(data);
    if (message.method === "server.hello") hello.push(message.params);
    else if (message.method === "$/progress") progress.push(message.params);
    else if (message.method === "scene.changed") changes.push(message.params);
    else if (message.method === undefined) answers.get(message.id)?.(message);
  });
  let last = 0;
  const send = (method, params) => socket.send(JSON.stringify({ jsonrpc: "2.0", method, params }));
  const ask = (method, params, id = ++last) => within(new Promise((resolve) => {
    answers.set(id, resolve);
    socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
  }), `answer to ${method}`);
  await hello.next("hello");
  return { socket, frames, changes, progress, ask, send };
}

// The same figures as the command line's, and the difference picture before them.
const a = await session();
const params = { scene: "builtin:box", size: [160, 90], algorithm: "sm:size=128", against: "samples32", difference: "png", request_id: 5 };
const compared = await a.ask("compare.run", params, "first");
assert.equal(compared.error, undefined, compared.error?.message);
const picture = await a.frames.next("difference picture");
assert.deepEqual([picture.kind, picture.codec, picture.width, picture.height, picture.id, picture.view], [2, 1, 160, 90, 5, 0]);
assert.equal(picture.payload.subarray(0, 4).toString("hex"), "89504e47");
assert.ok(picture.reserved.every((b) => b === 0));
const local = JSON.parse(execFileSync(process.env.GNOMON, ["compare", "builtin:box", "--size", "160x90", "--algorithm", "sm:size=128", "--against", "samples32", "--json", "-", "--quiet"]));
// Files have 12 digits.
const rounded = (value) => JSON.parse(JSON.stringify(value, (_, x) => (typeof x === "number" ? Number(x.toPrecision(11)) : x)));
assert.deepEqual(Object.keys(compared.result).sort(), Object.keys(local).sort());
for (const name of ["receivers", "misclassified", "rmse", "max_abs", "leaks", "acne", "boundary", "algorithm", "params", "against", "size"])
  assert.deepEqual(rounded(compared.result[name]), rounded(local[name]), name);
// What is told first depends on how soon the render thread takes it.
const stages = ["waiting", "rendering", "comparing", "encoding"];
assert.ok(a.progress.length > 0 && a.progress.every((p, i) => p.id === "first" && stages.indexOf(p.stage) >= (i ? stages.indexOf(a.progress[i - 1].stage) : 0)), JSON.stringify(a.progress));

// A stream goes on while a comparison runs; both end well.
const b = await session();
const view = (await b.ask("view.open", { size: [32, 18] })).result.view;
await b.frames.next("first frame");
b.send("frame.ack", { view, frame: 1 });
const running = a.ask("compare.run", { ...params, size: [320, 180], frames: 3 });
let over = false, during = 0, seq = 1;
void running.then(() => (over = true));
while (!over) {
  b.send("view.set", { view, quality: 50 + (seq % 40), input_seq: ++seq });
  let frame;
  do {
    frame = await b.frames.next("frame beside a comparison");
    b.send("frame.ack", { view, frame: frame.frame });
  } while (frame.seq < seq);
  during++;
}
assert.equal((await running).error, undefined);
assert.ok(during >= 3, `${during} frames beside the comparison`);
assert.ok(a.progress.some((p) => p.stage === "comparing" && p.done > 0), "progress of the comparison");

// $/cancel answers the request it names with -32007, and what follows is served.
const long = a.ask("compare.run", { ...params, size: [640, 360], against: "point" }, "long");
const given = await a.ask("$/cancel", { id: "long" });
assert.deepEqual(given.result, { cancelled: true });
assert.equal((await long).error.code, -32007);
assert.deepEqual((await a.ask("$/cancel", { id: "long" })).result, { cancelled: false });
const loading = a.ask("scene.load", { scene: "builtin:dragon:triangles=400000" }, 77);
assert.deepEqual((await a.ask("$/cancel", { id: 77 })).result, { cancelled: true });
assert.equal((await loading).error.code, -32007);
assert.deepEqual((await b.ask("$/cancel", { id: "long" })).result, { cancelled: false }, "not another session's");
assert.ok(a.progress.some((p) => p.id === 77 && p.stage === "loading"));
while (a.frames.items.length) a.frames.items.shift();

// Snapshots at their own size, in every format, to whoever asked.
for (const [format, codec, magic] of [["jpeg", 0, "ffd8ff"], ["png", 1, "89504e47"], ["webp", 2, "52494646"], ["exr", 3, "762f3101"]]) {
  const { result } = await a.ask("render.snapshot", { size: [99, 41], format, request_id: 40 + codec });
  const taken = await a.frames.next(format);
  assert.deepEqual([taken.kind, taken.codec, taken.width, taken.height, taken.id], [1, codec, 99, 41, 40 + codec]);
  assert.equal(taken.payload.subarray(0, magic.length / 2).toString("hex"), magic);
  assert.equal(result.bytes, taken.payload.length);
}

// A view streams each codec; PNG alone is lossless.
for (const [codec, number, magic] of [["webp", 2, "52494646"], ["png", 1, "89504e47"], ["jpeg", 0, "ffd8ff"]]) {
  await b.ask("view.set", { view, codec, input_seq: ++seq });
  let frame;
  do {
    frame = await b.frames.next(codec);
    b.send("frame.ack", { view, frame: frame.frame });
  } while (frame.seq < seq);
  assert.equal(frame.codec, number);
  assert.equal(Boolean(frame.flags & 4), codec === "png");
  assert.equal(frame.payload.subarray(0, magic.length / 2).toString("hex"), magic);
}

// A file that changes is told of, and read anew by who asks again.
const small = '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"camera":0}],"cameras":[{"name":"first","type":"perspective","perspective":{"yfov":1,"znear":0.1}}]}';
writeFileSync(join(folder, "shed.gltf"), small);
const shed = await a.ask("view.open", { scene: "shed.gltf", size: [32, 18] });
assert.equal(shed.error, undefined, shed.error?.message);
writeFileSync(join(folder, "shed.gltf"), small.replace("first", "second"));
const told = await a.changes.next("scene.changed");
assert.deepEqual(told, { scene: "shed.gltf", reason: "changed", views: [shed.result.view] });
assert.deepEqual((await b.changes.next("scene.changed")).views, []);
assert.equal((await a.ask("scene.describe", { scene: "shed.gltf" })).result.cameras[0].name, "second");

// Too many at once are told so, not kept.
const many = await Promise.all(Array.from({ length: 8 }, () => a.ask("compare.run", { ...params, size: [64, 36], difference: undefined })));
assert.ok(many.some((m) => m.error?.code === -32004) && many.some((m) => m.result), "some are served, some refused");

// Ending with a comparison under way is still an end.
void a.ask("compare.run", { ...params, size: [640, 360] }).catch(() => undefined);
await a.ask("scene.describe", { scene: "builtin:box" });
const end = await server.stop();
assert.equal(end.code, 0, end.err);
assert.ok(end.ms < 5000, `${end.ms} ms`);
console.log(`all good: ${during} frames beside a comparison`);
process.exit(0);
