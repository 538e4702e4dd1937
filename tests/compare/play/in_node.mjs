// Answers messages in WebAssembly, as the page's worker does: node in_node.mjs FOLDER MESSAGES, a file with a line of JSON each.
// Each answer is [seconds of CPU, the last answer]; the first line is the seconds that starting took.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const folder = path.resolve(process.argv[2]);
const cpu = () => { const { user, system } = process.cpuUsage(); return (user + system) / 1e6; };
const worker = fs.readFileSync(path.join(folder, "worker.js"), "utf8");
const [, place] = /PLACE = "([^"]+)"/.exec(worker);
const [, code] = /ASK = `([^`]+)`/.exec(worker);
const { loadPyodide } = await import(pathToFileURL(path.join(folder, "pyodide.mjs")).href);
const python = await loadPyodide({ indexURL: folder + path.sep });
for (const [name, format] of [["flint.zip", "zip"], ["truebreak.tar.bz2", "bztar"]]) {
  const bytes = new Uint8Array(fs.readFileSync(path.join(folder, name)));
  python.unpackArchive(bytes.slice().buffer, format, { extractDir: place });
}
python.runPython(code.replace("${PLACE}", place));
const ask = python.globals.get("ask");
console.log(JSON.stringify(cpu()));
for (const line of fs.readFileSync(process.argv[3], "utf8").split("\n").filter(Boolean)) {
  const [before, told] = [cpu(), []];
  ask(line, (text) => told.push(text));
  console.log(`[${cpu() - before}, ${told.at(-1)}]`);
}
