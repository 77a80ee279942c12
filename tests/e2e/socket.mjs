// The WebSocket: hello, a view, frames and credit.
import assert from "node:assert/strict";
import { Client, PATIENCE_MS, WebSocket, inbox, metric, serve, sleep } from "./support.mjs";

const server = await serve();
const connect = (hold = false) => {
  const hellos = inbox(), frames = inbox(), stats = inbox(), closes = inbox();
  const client = new Client(server.wsUrl, {
    hello: (hello) => hellos.push(hello),
    frame: (frame) => { frames.push(frame); return hold ? new Promise(() => undefined) : undefined; },
    stats: (s) => stats.push(s),
    closed: (code) => closes.push(code),
  }, WebSocket);
  return { client, hellos, frames, stats, closes };
};
const rejects = (promise, code, text) => assert.rejects(promise, (error) => {
  assert.equal(error.code, code, error.message);
  assert.match(error.message, text);
  return true;
});

// hello comes first, and says what there is.
const a = connect();
const hello = await a.hellos.next("hello");
assert.ok(hello.version && hello.session && hello.limits.views > 0);
assert.ok(hello.scenes.some((s) => s.name === "builtin:box"));
assert.ok(hello.algorithms.length >= 2 && hello.algorithms.every((x) => x.name && Array.isArray(x.params)));

// Scenes.
const scene = await a.client.request("scene.describe", { scene: "builtin:box" });
assert.ok(scene.triangles > 0 && scene.bounds.min.length === 3);
await rejects(a.client.request("scene.load", { scene: "../../etc/passwd" }), -32000, /no scene/);

// A view sends a frame at once, and a still one after a pause; then nothing.
const view = await a.client.openView({ scene: "builtin:box", size: [320, 180] });
assert.deepEqual(view.size, [320, 180]);
const first = await a.frames.next("first frame");
assert.equal(first.codec, "jpeg");
assert.deepEqual([first.view, first.frame, first.kind, first.width, first.height], [view.view, 1, 0, 320, 180]);
assert.equal(first.inputSeq, 1);
assert.ok(first.inputTimeUs > 0 && first.renderUs > 0 && first.encodeUs > 0);
assert.deepEqual([...first.payload.subarray(0, 3)], [0xff, 0xd8, 0xff]);
assert.equal(hello.algorithms[first.algorithm].name, view.algorithm.split(":")[0]);
const still = await a.frames.next("still frame");
assert.equal(still.flags & 2, 2);
assert.ok(still.payload.length > first.payload.length, "quality rises when still");
await sleep(600);
assert.equal(a.frames.items.length, 0, "a still view renders nothing");

// Input is echoed; a size change takes effect.
await a.client.setView(view.view, { size: [200, 100], dpr: 2, camera: { eye: [4, 3, 5], target: [0, 0, 0] } });
const moved = await a.frames.next("moved frame");
assert.deepEqual([moved.inputSeq, moved.width, moved.height], [2, 400, 200]);
await a.frames.next("still frame");

// Each algorithm renders; those that refine a still picture send more than its two frames.
for (const [index, algorithm] of hello.algorithms.entries()) {
  await a.client.setView(view.view, { algorithm: algorithm.name, size: [64, 36], dpr: 1 });
  while ((await a.frames.next(`frame of ${algorithm.name}`)).algorithm !== index);
}
do {
  a.frames.items.length = 0;
  await sleep(1000);
} while (a.frames.items.length);

// Lights.
const lights = await a.client.request("light.add", { view: view.view, light: { kind: "point", position: [0, 3, 0], intensity: 50 } });
assert.equal(lights.index, lights.lights.length - 1);
await a.frames.next("frame with the light");
await a.frames.next("still frame");
await a.client.request("light.remove", { view: view.view, index: lights.index });
await a.frames.next("frame without the light");
await a.frames.next("still frame");

// What is refused, and that it leaves the view alone.
await rejects(a.client.request("view.set", { view: view.view, sice: [1, 1], x: 1 }), -32602, /sice, x/);
await rejects(a.client.request("view.set", { view: view.view, size: [0, 5] }), -32602, /size/);
await rejects(a.client.request("view.set", { view: view.view, quality: "high" }), -32602, /quality.*1 to 100/);
await rejects(a.client.request("view.set", { view: view.view, algorithm: "nonesuch" }), -32602, /nonesuch/);
await rejects(a.client.request("view.set", { view: 999 }), -32002, /no such view/);
await rejects(a.client.request("frame.ack", { view: view.view, frame: 1e9 }), -32602, /frame/);
await rejects(a.client.request("nonesuch"), -32601, /nonesuch/);
await sleep(400);
assert.equal(a.frames.items.length, 0, "what is refused changes nothing");

// Statistics come each second.
const stats = await a.stats.next("view.stats");
for (const key of ["fps", "frame_ms", "passes", "encode_ms", "bytes", "dropped", "in_flight", "rtt_ms", "algorithm", "params", "shadow_bytes"])
  assert.ok(key in stats, key);

// Another client's view is nobody else's.
const b = connect(true);
await b.hellos.next("hello");
await rejects(b.client.request("view.close", { view: view.view }), -32002, /no such view/);

// A client that never acknowledges gets one frame, and costs nothing afterwards.
const held = await b.client.openView({ scene: "builtin:box", size: [320, 180] });
const drive = async (client, id, times) => {
  for (let i = 0; i < times; i++) {
    client.steer(id, { camera: { eye: [4 + i * 0.01, 3, 5], target: [0, 0, 0] } });
    await sleep(10);
  }
};
await drive(b.client, held.view, 60);
await sleep(300);
assert.equal(b.frames.items.length, 1, "one frame under way");
const before = await metric(server.url, "gnomon_frames_rendered_total");
await drive(b.client, held.view, 60);
await sleep(300);
assert.equal(await metric(server.url, "gnomon_frames_rendered_total"), before, "without credit nothing is rendered");
assert.ok(await metric(server.url, 'gnomon_frames_dropped_total{reason="credit"}') > 0);
// Its credit back, it sees the newest state, not the oldest.
b.client.ack(b.frames.items[0]);
b.frames.items.length = 0;
assert.equal((await b.frames.next("newest frame")).inputSeq, 121);

// A client that stops reading its socket holds up nobody.
const c = connect();
await c.hellos.next("hello");
const big = await c.client.openView({ scene: "builtin:box", size: [1280, 720] });
await c.frames.next("first frame");
c.client.socket._socket.pause();
await drive(c.client, big.view, 20);
await a.client.setView(view.view, { camera: { eye: [3, 3, 5], target: [0, 0, 0] } });
await a.frames.next("frame beside a stuck client");
c.client.socket.terminate();

// Hostile messages.
const raw = async (send) => {
  const socket = new WebSocket(server.wsUrl, "gnomon.v1"), messages = inbox(), closes = inbox();
  socket.on("message", (data) => messages.push(JSON.parse(data.toString())));
  socket.on("close", (code) => closes.push(code));
  socket.on("error", () => undefined);
  await messages.next("hello");
  send(socket);
  return { socket, messages, closes };
};
const broken = await raw((socket) => socket.send("{nonsense"));
assert.equal((await broken.messages.next("answer")).error.code, -32700);
broken.socket.send("[1]");
assert.equal((await broken.messages.next("answer")).error.code, -32600);
broken.socket.send('{"jsonrpc":"2.0","method":"view.set","id":[],"params":{}}');
assert.equal((await broken.messages.next("answer")).error.code, -32600);
broken.socket.send('{"jsonrpc":"2.0","method":"view.set","id":1,"params":[1]}');
assert.equal((await broken.messages.next("answer")).error.code, -32602);
broken.socket.terminate();
const long = await raw((socket) => socket.send(`"${"x".repeat(2 << 20)}"`));
assert.equal(await long.closes.next("close"), 1009);
const binary = await raw((socket) => socket.send(Buffer.alloc(8)));
assert.equal(await binary.closes.next("close"), 1003);

// A picture on request.
const taken = await a.client.request("render.snapshot", { scene: "builtin:box", size: [100, 50], format: "png", request_id: 77 });
let picture; // after what its view still had under way
do picture = await a.frames.next("snapshot");
while (picture.kind !== 1);
assert.deepEqual([picture.kind, picture.requestId, picture.codec, taken.request_id], [1, 77, "png", 77]);

await a.client.request("view.close", { view: view.view });
await rejects(a.client.request("view.close", { view: view.view }), -32002, /no such view/);

const end = await server.stop();
assert.equal(end.code, 0, end.err);
assert.ok(end.ms < 5000, `shut down in ${end.ms} ms`);
assert.match(end.out, /^gnomon: ready \S+\n$/);
console.log(`all good (patience ${PATIENCE_MS} ms, ended in ${end.ms} ms)`);
process.exit(0);
