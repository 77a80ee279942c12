// gnomon.openrpc.json, its references followed. Throws on one that leads nowhere and on names used twice.
import { readFileSync } from "node:fs";

export function loadDocument(path = new URL("gnomon.openrpc.json", import.meta.url)) {
  const document = JSON.parse(readFileSync(path, "utf8"));
  const names = new Set();
  for (const { name } of [...document.methods, ...document["x-notifications"]]) {
    if (names.has(name)) throw new Error(`${name} is listed twice`);
    names.add(name);
  }
  for (const method of document.methods) {
    method.params = method.params.map((param) => follow(document, param));
    method.errors = method.errors.map((error) => follow(document, error));
  }
  return document;
}

export function follow(document, value) {
  if (value.$ref === undefined) return value;
  let at = document;
  for (const key of value.$ref.replace(/^#\//, "").split("/")) at = at?.[key];
  if (at === undefined) throw new Error(`${value.$ref} leads nowhere`);
  return at;
}

// The last word of a reference to a schema, or "".
export const refName = (schema) => (schema.$ref ?? "").split("/").pop();

// Why `value` does not fit `schema`, or "". As much of JSON Schema as the document uses.
export function misfit(document, schema, value, where = "result") {
  if (schema.$ref) return misfit(document, follow(document, schema), value, where);
  if (schema.oneOf) return schema.oneOf.some((s) => misfit(document, s, value, where) === "") ? "" : `${where}: fits none of ${schema.oneOf.length} forms`;
  if ("const" in schema) return value === schema.const ? "" : `${where}: not ${schema.const}`;
  const type = value === null ? "null" : Array.isArray(value) ? "array" : typeof value;
  const wanted = schema.type === "integer" ? "number" : schema.type;
  if (wanted && type !== wanted) return `${where}: ${type} where ${schema.type} is promised`;
  if (schema.type === "integer" && !Number.isInteger(value)) return `${where}: ${value} is not whole`;
  if (schema.enum && !schema.enum.includes(value)) return `${where}: ${value} is not one of ${schema.enum}`;
  if (value < schema.minimum || value > schema.maximum) return `${where}: ${value} is out of range`;
  if (type === "array") return misfitItems(document, schema, value, where);
  if (type === "object") return misfitMembers(document, schema, value, where);
  return "";
}

function misfitItems(document, schema, value, where) {
  if (value.length < (schema.minItems ?? 0) || value.length > (schema.maxItems ?? Infinity)) return `${where}: ${value.length} items`;
  return schema.items ? value.map((item, i) => misfit(document, schema.items, item, `${where}[${i}]`)).find(Boolean) ?? "" : "";
}

function misfitMembers(document, schema, value, where) {
  for (const name of schema.required ?? []) if (!(name in value)) return `${where}.${name}: missing`;
  for (const [name, item] of Object.entries(value)) {
    const known = schema.properties?.[name] ?? (typeof schema.additionalProperties === "object" ? schema.additionalProperties : undefined);
    if (!known && schema.additionalProperties === false) return `${where}.${name}: not in the document`;
    const wrong = known ? misfit(document, known, item, `${where}.${name}`) : "";
    if (wrong) return wrong;
  }
  return "";
}
