// Checks a certificate by verify.mjs itself, which is written for node: it is given what it asks of node.
import { give } from "./node_here.js";

onmessage = async ({ data }) => {
  const lines = [];
  give(new TextEncoder().encode(data));
  globalThis.Buffer = { alloc: (length) => new Uint8Array(length) };
  globalThis.process = { argv: ["node", "verify.mjs", "certificate"], exitCode: 0 };
  console.log = (line) => lines.push(line);
  await import("./verify.mjs");
  postMessage(lines.join(" "));
};
