// What one client may do to another: a flood of view.set, and a client that stops reading. No timed asserts; SECONDS_EACH (default 2) says how long each
// part runs, and the figures are printed: `SECONDS_EACH=60 sh tests/e2e/node.sh build/release flood.mjs`, or `./dev soak`.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { WebSocket, inbox, serve, sleep } from "./support.mjs";

const seconds = Number(process.env.SECONDS_EACH ?? 2), FLOOD_PER_SECOND = 1000;
const server = await serve("--scene", "builtin:box", "--size", "160x90");
const rss = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.pid}/status`, "utf8"))[1]) / 1024;

async function client() {
  const socket = new WebSocket(server.wsUrl, "gnomon.v1"), hello = inbox(), answers = inbox(), c = { socket, frames: 0, last: 0, shown: inbox(), stats: null, gapMs: 0, at: 0 };
  c.send = (method, params, id) => socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
  socket.on("message", (data, binary) => {
    if (!binary) {
      const message = JSON.parse(data);
      if (message.method === "server.hello") hello.push(message);
      else if (message.method === "view.stats") c.stats = message.params;
      else if (message.id) answers.push(message.result);
      return;
    }
    const now = performance.now();
    if (c.at) c.gapMs = Math.max(c.gapMs, now - c.at);
    c.at = now;
    c.frames++;
    c.last = data.readUInt32LE(32);
    c.send("frame.ack", { view: data.readUInt32LE(12), frame: Number(data.readBigUInt64LE(16)) });
    c.shown.push(c.last);
    c.onFrame?.();
  });
  await hello.next("hello");
  c.send("view.open", { size: [160, 90], input_seq: 1 }, 1);
  c.view = (await answers.next("view")).view;
  await c.shown.next("first frame");
  return c;
}

const eye = (i) => [4 * Math.cos(i / 40), 3, 4 * Math.sin(i / 40)];
const steer = (c, i) => c.send("view.set", { view: c.view, camera: { eye: eye(i), target: [0, 0.5, 0] }, input_seq: i });

// Frames a second of a client that moves with every frame it gets.
async function paced(c) {
  let i = c.last;
  c.frames = c.gapMs = c.at = 0;
  c.onFrame = () => steer(c, ++i);
  steer(c, ++i);
  const start = performance.now();
  await sleep(seconds * 1000);
  c.onFrame = undefined;
  return { fps: c.frames / ((performance.now() - start) / 1000), gap: c.gapMs };
}

const other = await client(), flooder = await client();
const alone = await paced(other);
// Beside a second client that moves at its own pace, which is its fair share.
const pair = paced(flooder);
const beside = await paced(other);
await pair;

// A thousand states a second from the second client.
let sent = flooder.last, flooding = true, framesAfter = 0;
const flood = (async () => {
  const start = performance.now(), first = sent;
  while (flooding) {
    while (sent - first < ((performance.now() - start) / 1000) * FLOOD_PER_SECOND) steer(flooder, ++sent);
    await sleep(1);
  }
})();
const flooded = await paced(other);
flooding = false;
await flood;
await sleep(0);
flooder.shown.items.length = 0;
flooder.onFrame = () => framesAfter++;
while (flooder.last < sent) await flooder.shown.next("the last state");
assert.equal(flooder.last, sent, "the last state is the one shown");
assert.ok(framesAfter <= 3, `the last state came after ${framesAfter} frames`); // one may have been on its way when counting began
console.log(`another client: ${alone.fps.toFixed(1)} frames/s alone, ${beside.fps.toFixed(1)} beside a second one, ${flooded.fps.toFixed(1)} beside a flood of ${FLOOD_PER_SECOND} view.set/s ` +
  `(longest gap ${alone.gap.toFixed(0)}, ${beside.gap.toFixed(0)}, ${flooded.gap.toFixed(0)} ms); the last state came with frame ${framesAfter}`);

// A client that stops reading, but not writing, in the midst of it.
const before = rss(), samples = [];
flooder.socket.pause();
await sleep(100); // what node had read already comes out still
const stuckAt = sent, framesBefore = flooder.frames;
let end = performance.now() + seconds * 1000, rendered = 0;
const steering = (async () => {
  while (performance.now() < end) { steer(flooder, ++sent); await sleep(1); }
})();
const sampling = (async () => {
  while (performance.now() < end) { samples.push(rss()); await sleep(100); }
})();
const unread = await paced(other);
await Promise.all([steering, sampling]);
assert.ok(flooder.frames <= framesBefore + 1, "no frame but one that node had begun to read");
flooder.shown.items.length = 0;
flooder.onFrame = () => rendered++;
flooder.socket.resume();
while (flooder.last < sent) await flooder.shown.next("the newest state");
assert.equal(flooder.last, sent, "who reads again gets the newest state");
assert.ok(rendered <= 3, `${rendered} frames: at most those in flight, then the newest`);
assert.ok(Math.max(...samples) < before + 64, `memory grew from ${before} to ${Math.max(...samples)} MiB`);
console.log(`beside a client that does not read: ${unread.fps.toFixed(1)} frames/s; memory ${before.toFixed(1)} MiB before, ${Math.min(...samples).toFixed(1)} to ${Math.max(...samples).toFixed(1)} meanwhile, ` +
  `${rss().toFixed(1)} after; ${sent - stuckAt} states sent unread, ${rendered} frames to the newest`);
assert.equal((await server.stop()).code, 0);
process.exit(0);
