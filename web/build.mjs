// Bundles the viewer into the folder given (default dist): index.html, style.css, app.js; and client.mjs for scripts and tests.
import { build } from "esbuild";
import { copyFile, mkdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "dist");
await mkdir(out, { recursive: true });
const common = { bundle: true, format: "esm", target: "es2022", logLevel: "warning", absWorkingDir: here };
await build({ ...common, entryPoints: ["src/app.ts"], outfile: join(out, "app.js"), minify: true });
await build({ ...common, entryPoints: ["src/client.ts"], outfile: join(out, "client.mjs") });
for (const name of ["index.html", "style.css"]) await copyFile(join(here, name), join(out, name));
