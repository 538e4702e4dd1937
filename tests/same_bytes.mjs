// Runs Python code in WebAssembly: node same_bytes.mjs FOLDER ENVIRONMENT CODE, where FOLDER has what same_bytes.py puts there.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, environment, code] = process.argv.slice(2);
const home = path.join(folder, "node_modules", "pyodide");
const { loadPyodide } = await import(pathToFileURL(path.join(home, "pyodide.mjs")).href);
const python = await loadPyodide({ indexURL: home + path.sep, env: JSON.parse(environment), stdout: (line) => console.log(line) });
const site = python.runPython("import site, sysconfig; sysconfig.get_path('purelib')");
const wheels = path.join(folder, "wheels");
for (const name of fs.readdirSync(wheels)) {
  const bytes = new Uint8Array(fs.readFileSync(path.join(wheels, name)));
  python.unpackArchive(bytes.slice().buffer, "zip", { extractDir: site });
}
python.runPython("import importlib; importlib.invalidate_caches()");
python.runPython(code);
