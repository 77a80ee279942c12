// The C side: one struct with every parameter that any method takes, one table of members a method, the methods with their handlers
// (declared here, so that a method without one does not link, and one without a method is a function without a prototype), the errors.
import { follow } from "./document.mjs";

const NOTE = "/* Made from proto/gnomon.openrpc.json by proto/generate.mjs. */\n";
const upper = (text) => text.replace(/^\$\//, "").replace(/[^A-Za-z0-9]/g, "_").toUpperCase();
const lower = (text) => upper(text).toLowerCase();
const quote = (text) => JSON.stringify(text);
const number = (x) => (Number.isInteger(x) && Math.abs(x) >= 2 ** 31 ? `${x}.0` : String(x));

// What members.h calls the schema's kind, the field's C declaration and the other initialisers.
function member(document, name, schema) {
  const s = follow(document, schema);
  const range = (r) => `, ${number(r.minimum)}, ${number(r.maximum)}`;
  if (s.type === "boolean") return { kind: "BOOL", field: `bool ${name}`, rest: "" };
  if (s.type === "integer" && s.enum)
    return { kind: "INTEGER", field: `uint64_t ${name}`, rest: `, ${Math.min(...s.enum)}, ${Math.max(...s.enum)}, .values = (const double[]){${s.enum.join(", ")}, 0}` };
  if (s.type === "integer") return { kind: "INTEGER", field: `uint64_t ${name}`, rest: range(s) };
  if (s.type === "number") return { kind: "NUMBER", field: `double ${name}`, rest: range(s) };
  if (s.type === "string" && s.enum)
    return { kind: "CHOICE", field: `int ${name}`, rest: `, .choices = (const char *const[]){${s.enum.map(quote).join(", ")}, NULL}` };
  if (s.type === "string") return { kind: "STRING", field: `const char *${name}`, rest: `, .max = ${s.maxLength}` };
  if (s.type === "array" && s.minItems === s.maxItems && s.minItems > 0 && s.items.minimum !== undefined)
    return { kind: "NUMBERS", field: `double ${name}[${s.minItems}]`, rest: `${range(s.items)}, .count = ${s.minItems}` };
  return { kind: "ANY", field: `json_t *${name}`, rest: "" };
}

// Name -> C declaration, over all methods; the same name is the same declaration everywhere.
function fields(document) {
  const all = new Map();
  for (const method of document.methods)
    for (const { name, schema } of method.params) {
      const { field } = member(document, name, schema);
      if (all.has(name) && all.get(name) !== field) throw new Error(`${method.name}: ${name} is another type elsewhere`);
      all.set(name, field);
    }
  if (all.size > 64) throw new Error("more than 64 parameters: struct given has 64 bits");
  return all;
}

const structs = (document) => Object.values(document.components.schemas).filter((s) => s["x-c"]);

function table(document, name, struct, bit, params) {
  const rows = params.map(({ name: param, schema, required }) => {
    const { kind, rest } = member(document, param, schema);
    return `    {${quote(param)}, MEMBER_${kind}, offsetof(struct ${struct}, ${param})${rest}, .bit = ${bit}${upper(param)}${required ? ", .required = true" : ""}},\n`;
  });
  return `const struct member ${name}[] = {\n${rows.join("")}    {0},\n};\n\n`;
}

export function makeHeader(document) {
  const all = fields(document);
  let out = `${NOTE}#pragma once\n\n#include "call.h"\n#include "members.h"\n`;
  out += `\n/* Every parameter that any method takes; a method fills those of its own table. */\nstruct params {\n${[...all.values()].map((f) => `    ${f};\n`).join("")}};\n`;
  out += `\n/* Bits of struct given. */\nenum param_bit {\n${[...all.keys()].map((n) => `    PARAM_${upper(n)},\n`).join("")}};\n`;
  for (const s of structs(document)) {
    const entries = Object.entries(s.properties);
    out += `\nstruct ${s["x-c"]}_members {\n${entries.map(([n, schema]) => `    ${member(document, n, schema).field};\n`).join("")}};\n`;
    out += `enum ${s["x-c"]}_bit {\n${entries.map(([n]) => `    ${upper(s["x-c"])}_${upper(n)},\n`).join("")}};\n`;
    out += `extern const struct member ${s["x-c"]}_members[];\n`;
  }
  out += `\n/* JSON-RPC error codes. */\nenum rpc_code {\n${Object.values(document.components.errors).map((e) => `    RPC_${e["x-name"]} = ${e.code},\n`).join("")}};\n`;
  out += "\nstruct protocol_error {\n    enum rpc_code code;\n    int http; /* status of the same failure */\n};\nextern const struct protocol_error protocol_errors[]; /* ended by code 0 */\n";
  out += `\n${document["x-notifications"].map((n) => `#define NOTIFY_${upper(n.name)} ${quote(n.name)}\n`).join("")}`;
  out += "extern const char *const protocol_notifications[]; /* ended by NULL */\n";
  out += "\n/* The handlers, in server/methods/. call.h says what they return. */\n";
  for (const { name } of document.methods)
    out += `enum outcome method_${lower(name)}(struct server *server, struct call *call, const struct params *params, struct given given,\n    json_t **result, struct error *err);\n`;
  out += "\nstruct method {\n    const char *name;\n    const struct member *members;\n    bool control; /* not for view tokens */\n" +
    "    enum outcome (*run)(struct server *server, struct call *call, const struct params *params, struct given given, json_t **result,\n                        struct error *err);\n};\n";
  out += "extern const struct method methods[]; /* ended by a name of NULL */\n";
  for (const { name } of document.methods) out += `#define METHOD_${upper(name)} ${quote(name)}\n`;
  return out;
}

export function makeTables(document) {
  let out = `${NOTE}#include "protocol.h"\n\n#include <stddef.h>\n\n`;
  for (const s of structs(document))
    out += table(document, `${s["x-c"]}_members`, `${s["x-c"]}_members`, `${upper(s["x-c"])}_`,
      Object.entries(s.properties).map(([name, schema]) => ({ name, schema, required: s.required.includes(name) })));
  for (const { name, params } of document.methods) out += "static " + table(document, `${lower(name)}_params`, "params", "PARAM_", params);
  out += "const struct method methods[] = {\n";
  for (const m of document.methods) out += `    {${quote(m.name)}, ${lower(m.name)}_params, ${Boolean(m["x-control"])}, method_${lower(m.name)}},\n`;
  out += "    {0},\n};\n\nconst struct protocol_error protocol_errors[] = {\n";
  for (const e of Object.values(document.components.errors)) out += `    {RPC_${e["x-name"]}, ${e["x-http"]}},\n`;
  out += `    {0},\n};\n\nconst char *const protocol_notifications[] = {\n${document["x-notifications"].map((n) => `    ${quote(n.name)},\n`).join("")}    NULL,\n};\n`;
  return out;
}
