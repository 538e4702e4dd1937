// Writes the log of a physics engine for `truebreak diff`: JSON lines, format truebreak/log-1. No dependency.
//
//     const log = new TruebreakLog((line) => stream.write(line), { engine: "mine 1.2", fields: ["x", "y", "vx", "vy"] });
//     log.outline("ball", [{ circle: 0.5 }]);
//     log.step(k, k * dt, { contacts: [["ball", "floor"]], states: { ball: [x, y, vx, vy] }, input: keys, energy });
//     log.end(k * dt);
//
// `write` is called with one line of text at a time, its newline included. `collected()` gives a log that is kept in
// memory instead, as a page in a browser needs it: its `text()` is the file.

export const FORMAT = "truebreak/log-1";

// JSON has no words for these numbers; a log has.
const SPECIAL = { NaN: "NaN", Infinity: "Infinity", "-Infinity": "-Infinity" };

function text(value) {
  if (typeof value === "number") return SPECIAL[value] ?? (Object.is(value, -0) ? "-0.0" : String(value));
  if (Array.isArray(value) || ArrayBuffer.isView(value)) return `[${Array.from(value, text).join(", ")}]`;
  if (value !== null && typeof value === "object") {
    const entries = Object.entries(value).filter(([, item]) => item !== undefined);
    return `{${entries.map(([key, item]) => `${JSON.stringify(key)}: ${text(item)}`).join(", ")}}`;
  }
  return JSON.stringify(value ?? null);
}

export class TruebreakLog {
  constructor(write, { engine = "", fields, bits = 53, ...settings } = {}) {
    this.write = write;
    this.line({ log: FORMAT, engine, bits, fields, ...settings });
  }

  line(value) {
    this.write(`${text(value)}\n`);
  }

  outline(body, outline) {
    this.line({ body, outline });
  }

  // What else is given beside contacts, states, hash and input is a free field, compared by its name.
  step(step, time, { contacts, states, hash, input, ...fields } = {}) {
    this.line({ step, time, contacts: contacts?.length ? contacts : undefined, states, hash, input, ...fields });
  }

  end(time) {
    this.line({ end: time });
  }
}

// FNV-1a, 64 bits, of numbers to the last bit: the hash of a state, where one is wanted.
export function hashOf(numbers) {
  const bytes = new Uint8Array(Float64Array.from(numbers).buffer);
  let hash = 14695981039346656037n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 1099511628211n);
  return hash.toString(16).padStart(16, "0");
}

export function collected(settings) {
  const lines = [];
  const log = new TruebreakLog((line) => lines.push(line), settings);
  return Object.assign(log, { text: () => lines.join("") });
}
