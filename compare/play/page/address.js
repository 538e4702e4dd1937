// The scene in the address of the page: short rows, compressed, in letters that any program passes on.
import { KINDS, checked, stands } from "./scene.js";

const MOST_ADDRESS = 60_000; // letters of an address that are read
const MOST_UNPACKED = 400_000; // bytes that they may stand for
const OTHERS = ["tie_policy", "events", "reverse_after", "reverse_at", "until", "capture", "restitution", "gravity"];
const DEFAULTS = { tie_policy: "simultaneous", restitution: "1" };

export async function packed(scene) {
  const rows = { n: scene.name };
  for (const [kind, { keys, letter }] of Object.entries(KINDS)) {
    const own = (thing) => (kind === "wall" && stands(thing) ? keys.slice(0, 4) : keys);
    if (scene[kind].length) rows[letter] = scene[kind].map((thing) => [thing.id, ...own(thing).map((key) => thing[key]), ...(thing.point ? [1] : thing.full ? [2] : [])]);
  }
  for (const key of OTHERS) if (scene[key] !== undefined && scene[key] !== DEFAULTS[key]) rows[key] = scene[key];
  const bytes = await through(new Blob([JSON.stringify(rows)]).stream().pipeThrough(new CompressionStream("deflate-raw")), Infinity);
  let letters = "";
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

// The scene that an address holds; throws a sentence where it holds none.
export async function unpacked(letters) {
  if (letters.length > MOST_ADDRESS) throw new Error(`the address has ${letters.length.toLocaleString("en")} letters; at most ${MOST_ADDRESS.toLocaleString("en")}`);
  let rows;
  try {
    const bytes = Uint8Array.from(atob(letters.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    rows = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(await through(stream, MOST_UNPACKED)));
  } catch {
    throw new Error("the address holds no scene");
  }
  const data = { name: rows?.n };
  for (const [kind, { keys, letter }] of Object.entries(KINDS)) {
    if (rows?.[letter] === undefined) continue;
    if (!Array.isArray(rows[letter])) throw new Error("the address holds no scene");
    data[kind] = rows[letter].map((row) => {
      if (!Array.isArray(row)) throw new Error("the address holds no scene");
      const thing = { id: row[0], ...Object.fromEntries(keys.map((key, k) => [key, row[k + 1]])) };
      if (kind === "arc" && row[keys.length + 1] === 2) return { id: row[0], x: row[1], y: row[2], r: row[3], full: true };
      return row[keys.length + 1] === 1 ? { ...thing, point: true } : thing;
    });
  }
  for (const key of OTHERS) if (rows?.[key] !== undefined) data[key] = rows[key];
  return checked(data);
}

async function through(stream, most) {
  const [parts, reader] = [[], stream.getReader()];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > most) { reader.cancel(); throw new Error("too long"); }
    parts.push(value);
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const part of parts) { bytes.set(part, at); at += part.length; }
  return bytes;
}

// What the address says: token, scene, lesson, or the name of a scene; in the fragment, or as a query where a page is linked to.
export function fragment() {
  return new URLSearchParams(location.hash.length > 1 ? location.hash.slice(1) : location.search);
}
