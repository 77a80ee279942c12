// REFERENCE.md: every method, notification, type and error in tables, with its examples.
import { refName } from "./document.mjs";

const cell = (text) => (text ?? "").replace(/\|/g, "\\|");
const anchor = (name) => name.toLowerCase().replace(/[^a-z0-9_-]/g, "");

function type(schema) {
  if (schema.$ref) return `[${refName(schema)}](#${anchor(refName(schema))})`;
  if (schema.oneOf) return schema.oneOf.map(type).join(" or ");
  if ("const" in schema) return `\`${JSON.stringify(schema.const)}\``;
  if (schema.enum) return schema.enum.map((v) => `\`${JSON.stringify(v)}\``).join(", ");
  if (schema.type === "array") {
    const counted = schema.minItems !== undefined && schema.minItems === schema.maxItems ? `${schema.minItems} of ` : schema.maxItems ? `up to ${schema.maxItems} of ` : "array of ";
    return counted + type(schema.items ?? {});
  }
  const range = schema.minimum !== undefined && schema.maximum !== undefined ? `, ${schema.minimum} to ${schema.maximum}` : schema.minimum !== undefined ? `, at least ${schema.minimum}` : "";
  const length = schema.maxLength ? `, ${schema.minLength ?? 0} to ${schema.maxLength} bytes` : "";
  return (schema.type ?? "any") + range + length;
}

function members(rows) {
  if (rows.length === 0) return "No members.\n";
  return `| member | | type | |\n|---|---|---|---|\n${rows.map(([name, required, schema]) => `| \`${name}\` | ${required ? "required" : ""} | ${cell(type(schema))} | ${cell(schema.description)} |\n`).join("")}`;
}

const code = (...values) => `\`\`\`json\n${values.map((v) => JSON.stringify(v)).join("\n")}\n\`\`\`\n`;

function method(m) {
  let out = `\n### ${m.name}\n\n${m.summary}${m.description ? ` ${m.description}` : ""}${m["x-control"] ? " Needs a control token." : ""}\n\n`;
  out += members(m.params.map((p) => [p.name, p.required, p.schema]));
  out += `\nResult: ${type(m.result.schema)}. Errors: -32602${m.errors.map((e) => `, ${e.code}`).join("")}.\n\n`;
  for (const [i, e] of m.examples.entries()) {
    const params = Object.fromEntries(e.params.map((p) => [p.name, p.value]));
    out += code({ jsonrpc: "2.0", id: i + 1, method: m.name, params }, { jsonrpc: "2.0", id: i + 1, result: e.result.value });
  }
  return out;
}

export function makeReference(document) {
  let out = "# Reference of gnomon.v1\n\nMade from `gnomon.openrpc.json` by `generate.mjs`; [README.md](README.md) tells how it hangs together. The examples run as tests.\n\n## Methods\n";
  for (const m of document.methods) out += method(m);
  out += "\n## Notifications\n";
  for (const n of document["x-notifications"])
    out += `\n### ${n.name}\n\n${n.summary} Parameters: ${type(n.params)}.\n\n${code({ jsonrpc: "2.0", method: n.name, params: n.example })}`;
  out += "\n## Types\n";
  for (const [name, s] of Object.entries(document.components.schemas)) {
    out += `\n### ${name}\n\n${s.description ?? ""}\n\n`;
    out += s.properties ? members(Object.entries(s.properties).map(([n, p]) => [n, s.required?.includes(n), p])) : `${type(s)}\n`;
  }
  out += "\n## Errors\n\n| code | HTTP | |\n|---|---|---|\n";
  for (const e of Object.values(document.components.errors)) out += `| ${e.code} | ${e["x-http"]} | ${e.message} |\n`;
  return out.replace(/\n{3,}/g, "\n\n");
}

