// The engines in the browser: Python and python-flint for WebAssembly, and truebreak itself, all from this folder.
import { loadPyodide } from "./pyodide.mjs";

const PLACE = "/lib/truebreak";
const ASK = `
import json, sys
sys.path.insert(0, "${PLACE}")
from truebreak.compare.play.messages import answer, engines_here

def ask(text, tell):
    answer(json.loads(text), lambda one: tell(json.dumps(one, allow_nan=False)))
`;
// Two collisions so close in time that doubles take them for one: what a run, and what its divergence, imports is used.
const WARM = { circle: [["a", "-3", "1"], ["b", "0", "0"], ["c", "3.00000000000000000001", "-1"]].map(([id, x, vx]) => ({ id, x, y: "0", r: "1", vx })) };

const say = (words, share) => postMessage({ kind: "loading", words, share });

async function started() {
  say("Loading Python, for exact arithmetic in this browser (the first time, 14 MB).", 0.05);
  const archives = [["flint.zip", "zip"], ["truebreak.tar.bz2", "bztar"]].map(async ([name, format]) => {
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(`${name} is not there`);
    return [await answer.arrayBuffer(), format];
  });
  const python = await loadPyodide({ indexURL: "./" });
  say("Loading the exact engine.", 0.6);
  for (const archive of archives) python.unpackArchive(...(await archive), { extractDir: PLACE });
  python.runPython(ASK);
  const ask = python.globals.get("ask");
  say("Starting the engines.", 0.8);
  ask(JSON.stringify({ kind: "run", scene: WARM, events: 10, why: true }), () => {}); // what is imported at the first run, is now
  postMessage({ kind: "ready", engines: python.globals.get("engines_here")().toJs() });
  return ask;
}

const ready = started();
ready.catch((error) => postMessage({ kind: "failed", error: `the engines did not load: ${error.message}` }));

onmessage = async ({ data }) => {
  const ask = await ready;
  try {
    ask(JSON.stringify(data), (text) => postMessage(JSON.parse(text)));
  } catch (error) {
    postMessage({ kind: "refused", error: String(error.message).trim().split("\n").pop() });
  }
};
