// What the scripts of this folder share: a server of their own, and requests that say what went wrong.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { request as httpRequest } from "node:http";
import { pathToFileURL } from "node:url";

const required = createRequire(new URL("../../web/package.json", import.meta.url));
export const WebSocket = required("ws");
export const playwright = () => required("playwright-core");
export const binaryDir = process.env.BINARY_DIR;
export const { Client } = await import(pathToFileURL(`${binaryDir}/web/dist/client.mjs`).href);

// A slow machine under a sanitizer still answers within this.
export const PATIENCE_MS = 60000;

export function within(promise, what, ms = PATIENCE_MS) {
  let timer;
  const late = new Promise((_, reject) => (timer = setTimeout(() => reject(new Error(`no ${what} within ${ms} ms`)), ms)));
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

export async function serve(...args) {
  const listen = args.includes("--listen") ? [] : ["--listen", "127.0.0.1:0"];
  const child = spawn(process.env.GNOMON, ["serve", ...listen, ...args], { stdio: ["ignore", "pipe", "pipe"] });
  process.on("exit", () => child.kill("SIGKILL")); // a test that fails leaves nothing running
  let out = "", err = "";
  child.stderr.on("data", (text) => (err += text));
  const exited = new Promise((resolve) => child.on("exit", (code, signal) => resolve({ code, signal, out, err })));
  const ready = new Promise((resolve, reject) => {
    child.stdout.on("data", (text) => {
      out += text;
      const line = /^gnomon: ready (http:\/\/\S+\/)\n/.exec(out);
      if (line) resolve(line[1]);
    });
    void exited.then(({ code }) => reject(new Error(`the server ended with ${code}: ${err}`)));
  });
  const url = await within(ready, "ready line").catch((error) => {
    child.kill("SIGKILL");
    // No device is no fault of the server's: the environment's.
    if (/no usable|no GL device/i.test(error.message)) { console.log(error.message); process.exit(77); }
    throw error;
  });
  return {
    url,
    wsUrl: `${url.replace("http", "ws")}ws`,
    pid: child.pid,
    log: () => err,
    async stop(signal = "SIGTERM") {
      const start = Date.now();
      child.kill(signal);
      const end = await within(exited, "exit", 10000).catch((error) => { child.kill("SIGKILL"); throw error; });
      return { ...end, ms: Date.now() - start };
    },
  };
}

// fetch() forbids Host and Origin: plain http.
export function http(url, { method = "GET", headers = {}, body } = {}) {
  return within(new Promise((resolve, reject) => {
    const request = httpRequest(url, { method, headers, agent: false }, (response) => {
      const chunks = [];
      response.on("data", (chunk) => chunks.push(chunk));
      response.on("end", () => resolve({ status: response.statusCode, headers: response.headers, body: Buffer.concat(chunks) }));
    });
    request.on("error", (error) => reject(new Error(`${method} ${url}: ${error.message}`)));
    request.end(body);
  }), `answer from ${url}`);
}

// The status of a refused upgrade, or 101.
export function upgrade(wsUrl, { protocol = "gnomon.v1", ...options } = {}) {
  return within(new Promise((resolve) => {
    const socket = new WebSocket(wsUrl, protocol ? [protocol] : [], options);
    socket.on("open", () => { socket.terminate(); resolve(101); });
    socket.on("unexpected-response", (_, response) => { socket.terminate(); resolve(response.statusCode); });
    socket.on("error", () => resolve(0));
  }), "upgrade");
}

// A queue of what a callback gets, to be awaited one by one.
export function inbox() {
  const items = [], waiting = [];
  return {
    items,
    push(item) { const next = waiting.shift(); if (next) next(item); else items.push(item); },
    next(what, ms) { return items.length ? Promise.resolve(items.shift()) : within(new Promise((resolve) => waiting.push(resolve)), what, ms); },
  };
}

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

export async function metric(url, name) {
  const text = (await http(`${url}metrics`)).body.toString();
  return text.split("\n").filter((line) => line.startsWith(name) && !line.startsWith("#"))
    .reduce((sum, line) => sum + Number(line.split(" ").pop()), 0);
}
