// The TypeScript side: one type a schema, the parameters and results of every method, the notifications' parameters.
import { refName } from "./document.mjs";

const pascal = (name) => name.replace(/^\$\//, "").replace(/(^|[._])([a-z])/g, (_, __, c) => c.toUpperCase());
const comment = (text, pad = "") => (text ? `${pad}// ${text}\n` : "");

function type(schema) {
  if (schema.$ref) return refName(schema);
  if (schema.oneOf) return [...new Set(schema.oneOf.map(type))].join(" | ");
  if ("const" in schema) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.map((v) => JSON.stringify(v)).join(" | ");
  switch (schema.type) {
    case "integer":
    case "number": return "number";
    case "array":
      if (schema.minItems === schema.maxItems && schema.minItems > 0) return `[${Array(schema.minItems).fill(type(schema.items)).join(", ")}]`;
      return /[| ]/.test(type(schema.items)) ? `(${type(schema.items)})[]` : `${type(schema.items)}[]`;
    case "object": return object(schema);
    case undefined: return "unknown";
    default: return schema.type;
  }
}

function object(schema) {
  const other = schema.additionalProperties;
  if (!schema.properties) return other === undefined ? "Record<string, unknown>" : `Record<string, ${type(other)}>`;
  const lines = Object.entries(schema.properties).map(([name, s]) => `  ${name}${schema.required?.includes(name) ? "" : "?"}: ${type(s)};${s.description ? ` // ${s.description}` : ""}\n`);
  return lines.length ? `{\n${lines.join("")}}` : "Record<string, never>";
}

const nested = (text) => text.replace(/\n/g, "\n  ");

export function makeTypes(document) {
  let out = "// Made from proto/gnomon.openrpc.json by proto/generate.mjs.\n";
  for (const [name, schema] of Object.entries(document.components.schemas)) {
    const text = type(schema);
    out += `\n${comment(schema.description)}export ${text.startsWith("{") ? `interface ${name} ${text}` : `type ${name} = ${text};`}\n`;
  }
  for (const method of document.methods)
    out += `\n${comment(method.summary)}export interface ${pascal(method.name)}Params {\n${method.params
      .map((p) => `  ${p.name}${p.required ? "" : "?"}: ${nested(type(p.schema))};\n`).join("")}}\n`;
  out += "\n// Method -> what goes and what comes back.\nexport interface Methods {\n";
  for (const method of document.methods) out += `  ${JSON.stringify(method.name)}: { params: ${pascal(method.name)}Params; result: ${nested(type(method.result.schema))} };\n`;
  out += "}\n\n// Notification -> its parameters.\nexport interface Notifications {\n";
  for (const n of document["x-notifications"]) out += `  ${JSON.stringify(n.name)}: ${type(n.params)};\n`;
  return `${out}}\n`;
}
