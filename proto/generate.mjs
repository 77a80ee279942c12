// node generate.mjs KIND OUT...: makes what follows from gnomon.openrpc.json beside it. Files that would not change are left alone.
//   c PROTOCOL_H PROTOCOL_C [DOCUMENT]   parameter, method and error tables for server/, of another document for the test
//   ts FILE                     types for web/
//   reference FILE              the reference page; `reference-check FILE` fails when FILE is not what would be made
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { makeHeader, makeTables } from "./generate_c.mjs";
import { makeTypes } from "./generate_ts.mjs";
import { makeReference } from "./generate_reference.mjs";
import { loadDocument } from "./document.mjs";

function write(path, text) {
  if (!existsSync(path) || readFileSync(path, "utf8") !== text) writeFileSync(path, text);
}

const [kind, ...out] = process.argv.slice(2);
const document = loadDocument(kind === "c" ? out[2] : undefined);
switch (kind) {
  case "c":
    write(out[0], makeHeader(document));
    write(out[1], makeTables(document));
    break;
  case "ts": write(out[0], makeTypes(document)); break;
  case "reference": write(out[0], makeReference(document)); break;
  case "reference-check":
    if (readFileSync(out[0], "utf8") !== makeReference(document)) {
      console.error(`${out[0]} is stale: node proto/generate.mjs reference ${out[0]}`);
      process.exit(1);
    }
    break;
  default:
    console.error("usage: generate.mjs c PROTOCOL_H PROTOCOL_C [DOCUMENT] | ts FILE | reference FILE | reference-check FILE");
    process.exit(64);
}
