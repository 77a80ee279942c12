// proto/gnomon.openrpc.json against a live server: every example passes and answers in the promised shape, every x-refused is refused with its code
// and field, every method refuses what is unknown and what is of the wrong type, every notification that comes is as promised.
import assert from "node:assert/strict";
import { follow, loadDocument, misfit } from "../../proto/document.mjs";
import { WebSocket, inbox, serve } from "./support.mjs";

const document = loadDocument();
const notified = new Map(document["x-notifications"].map((n) => [n.name, n.params]));
const seen = new Set();
for (const n of document["x-notifications"]) assert.equal(misfit(document, n.params, { ...n.example }, n.name).replace(/.*missing$/, ""), "");

const server = await serve("--scene", "builtin:box", "--size", "320x180");

// A session of its own for each request, with a view and the frames it got.
async function session() {
  const socket = new WebSocket(server.wsUrl, "gnomon.v1"), hello = inbox(), frames = inbox(), answers = inbox();
  socket.on("message", (data, binary) => {
    if (binary) return void frames.push(data);
    const message = JSON.parse(data);
    if (message.method === undefined) return void answers.push(message);
    assert.ok(notified.has(message.method), `${message.method} is not in the document`);
    assert.equal(misfit(document, notified.get(message.method), message.params, message.method), "");
    seen.add(message.method);
    if (message.method === "server.hello") hello.push(message.params);
  });
  let last = 0;
  const ask = async (method, params) => {
    const id = ++last;
    socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    const answer = await answers.next(`answer to ${method} ${JSON.stringify(params)}`);
    assert.equal(answer.id, id);
    assert.equal(answer.jsonrpc, "2.0");
    return answer;
  };
  return { socket, ask, frames, hello: await hello.next("hello") };
}

// Examples name view 1; a session's view has a number of its own.
async function withView(use) {
  const s = await session();
  const view = (await s.ask("view.open", { size: [64, 36] })).result.view;
  await s.frames.next("frame");
  try {
    return await use(s, (params) => (params.view === 1 ? { ...params, view } : params));
  } finally {
    s.socket.terminate();
  }
}

// Members of the example are in the answer, with values of the same type.
function assertShape(example, answer, where) {
  if (example === null || answer === null) return;
  assert.equal(typeof answer, typeof example, where);
  if (typeof example === "object" && !Array.isArray(example))
    for (const name of Object.keys(example)) {
      assert.ok(name in answer, `${where}.${name} is missing`);
      assertShape(example[name], answer[name], `${where}.${name}`);
    }
}

function wrongValue(schema) {
  const s = follow(document, schema);
  return s.type === "string" ? 5 : s.type === "boolean" ? "true" : s.type === "object" ? "none" : s.type === "array" ? {} : s.oneOf ? false : "many";
}

async function refused(method, params, code, field) {
  await withView(async (s, own) => {
    const { error } = await s.ask(method, own(params));
    assert.ok(error, `${method} took ${JSON.stringify(params)}`);
    assert.deepEqual([error.code, error.data.field], [code, field], `${method} ${JSON.stringify(params)}: ${error.message}`);
    assert.ok(String(error.code) in document.components.errors);
    assert.match(error.message, /\w/);
  });
}

let examples = 0, refusals = 0;
for (const method of document.methods) {
  assert.ok(method.examples.length > 0 && method["x-refused"].length > 0, method.name);
  for (const example of method.examples) {
    const params = Object.fromEntries(example.params.map((p) => [p.name, p.value]));
    await withView(async (s, own) => {
      const answer = await s.ask(method.name, own(params));
      assert.equal(answer.error, undefined, `${method.name}: ${answer.error?.message}`);
      assert.equal(misfit(document, method.result.schema, answer.result, method.name), "");
      assertShape(example.result.value, answer.result, method.name);
    });
    examples++;
  }
  for (const { params, code, field } of method["x-refused"]) await refused(method.name, params, code, field), refusals++;
  const good = Object.fromEntries(method.examples[0].params.map((p) => [p.name, p.value]));
  await refused(method.name, { ...good, nonesuch: 1 }, -32602, "nonesuch");
  for (const param of method.params) await refused(method.name, { ...good, [param.name]: wrongValue(param.schema) }, -32602, param.schema.$ref ? param.name.replace(/^light$/, "kind") : param.name);
  refusals += 1 + method.params.length;
}
const { hello, socket } = await session();
socket.terminate();
assert.deepEqual(hello.capabilities.methods, document.methods.map((m) => m.name));
assert.deepEqual(hello.capabilities.notifications, document["x-notifications"].map((n) => n.name));
assert.ok(seen.has("server.hello"));
const end = await server.stop();
assert.equal(end.code, 0, end.err);
console.log(`${examples} examples, ${refusals} refusals, notifications seen: ${[...seen].join(", ")}`);
process.exit(0);
