// Messages that nobody honest sends: each is refused, or ends its own connection, and the server goes on.
import assert from "node:assert/strict";
import { WebSocket, inbox, serve } from "./support.mjs";

const server = await serve("--scene", "builtin:box", "--size", "64x36");
async function raw() {
  const socket = new WebSocket(server.wsUrl, "gnomon.v1"), messages = inbox(), closes = inbox();
  socket.on("message", (data, binary) => binary || messages.push(JSON.parse(data.toString())));
  socket.on("close", (code) => closes.push(code));
  socket.on("error", () => undefined);
  await messages.next("hello");
  return { socket, messages, closes };
}
const ask = async (text, code) => {
  const s = await raw();
  s.socket.send(text);
  const answer = await s.messages.next(`answer to ${text.slice(0, 60)}`);
  assert.equal(answer.error?.code, code, `${text.slice(0, 60)}: ${JSON.stringify(answer).slice(0, 200)}`);
  s.socket.terminate();
};
const request = (params, method = "view.open") => `{"jsonrpc":"2.0","id":1,"method":"${method}","params":${params}}`;

for (const text of ["", "{", "nonsense", '{"a":1,"a":2}', "[".repeat(200000), '{"a":'.repeat(100000), '"\\ud800"', "\u0000", '{"jsonrpc":"2.0"} {}']) await ask(text, -32700);
for (const text of ["1", "[]", "null", "[1]", '{"jsonrpc":"1.0","id":1,"method":"view.open"}', '{"jsonrpc":"2.0","id":{},"method":"view.open"}', '{"jsonrpc":"2.0","id":1,"method":5}',
  '{"jsonrpc":"2.0","id":1,"method":"view.open","extra":1}']) await ask(text, -32600);
await ask('{"jsonrpc":"2.0","id":1,"method":"rm -rf"}', -32601);
for (const params of ["[1]", "5", '{"size":[1e999,1]}', '{"size":[1,2,3]}', '{"size":"1x1"}', '{"size":[-1,5]}', '{"quality":1.5}', '{"dpr":0}', '{"lights":{}}', '{"camera":{"eye":[0,0,0],"target":[0,0,0]}}',
  '{"camera":-1}', '{"lights":[{"kind":"spot","inner":50,"outer":10}]}', `{"scene":"${"x".repeat(300)}"}`, '{"input_seq":4294967296}'])
  await ask(request(params), params.includes("1e999") ? -32700 : -32602);
await ask(request(`{"lights":[${'{"kind":"point"},'.repeat(16)}{"kind":"point"}]}`), -32602);

// What closes: too long, binary, not UTF-8.
const closing = async (send, code) => {
  const s = await raw();
  send(s.socket);
  assert.equal(await s.closes.next("close"), code);
};
await closing((s) => s.send(`"${"x".repeat((1 << 20) + 1)}"`), 1009);
await closing((s) => s.send(Buffer.from([0x47, 0x4e, 0x4d, 0x46, 255, 0, 1])), 1003);
await closing((s) => s.send(Buffer.from([0x22, 0xff, 0xfe, 0x22]), { binary: false }), 1007);

const s = await raw();
s.socket.send(request("{}"));
let answer;
do answer = await s.messages.next("answer"); while (!answer.id);
assert.ok(answer.result.view > 0, "and the server goes on");
const end = await server.stop();
assert.equal(end.code, 0, end.err);
console.log("all good");
process.exit(0);
