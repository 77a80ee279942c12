// What scripts may import: the connection without the page. Built as client.mjs.
export * from "./client.js";
export * from "./connection.js";
