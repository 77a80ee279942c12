// Bundles the viewer into the folder given (default dist): index.html, style.css, app.js; and client.mjs for scripts and tests.
import { build } from "esbuild";
import { copyFile, mkdir, readFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const kib = (bytes) => (bytes / 1024).toFixed(1);

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "dist");
// lil-gui brings four arrows as a font in a data: address, which the page's policy forbids; every system has them.
const withoutFonts = {
  name: "without fonts",
  setup: (builder) => builder.onLoad({ filter: /lil-gui\.css$/ }, async ({ path }) => ({
    contents: (await readFile(path, "utf8")).replace(/@font-face\s*\{[^}]*\}/g, ""),
    loader: "css",
  })),
};
await mkdir(out, { recursive: true });
const common = { bundle: true, format: "esm", target: "es2022", logLevel: "warning", absWorkingDir: here };
await build({ ...common, entryPoints: ["src/app.ts"], outfile: join(out, "app.js"), minify: true, legalComments: "eof" });
await build({ ...common, entryPoints: ["style.css"], outfile: join(out, "style.css"), minify: true, plugins: [withoutFonts] });
await build({ ...common, entryPoints: ["src/library.ts"], outfile: join(out, "client.mjs") });
await copyFile(join(here, "index.html"), join(out, "index.html"));

for (const name of ["app.js", "style.css", "index.html"]) {
  const bytes = await readFile(join(out, name));
  console.log(`${name}: ${kib(bytes.length)} KiB, ${kib(gzipSync(bytes).length)} KiB gzipped`);
}
