// What verify.mjs takes from node: one file to read, and SHA-256 (FIPS 180-4).
let [content, at] = [new Uint8Array(), 0];

export function give(bytes) { [content, at] = [bytes, 0]; }
export const constants = { O_RDONLY: 0, O_NONBLOCK: 0 };
export const openSync = () => 3;
export const closeSync = () => {};
export const fstatSync = () => ({ isFile: () => true, size: content.length });

// From where the last one ended, as node does where no position is given.
export function readSync(file, into, offset, length) {
  const part = content.subarray(at, at + length);
  into.set(part, offset);
  at += part.length;
  return part.length;
}

const PRIMES = [];
for (let n = 2; PRIMES.length < 64; n++) if (PRIMES.every((prime) => n % prime)) PRIMES.push(n);

// The first 32 bits of the fraction of a root, by whole numbers: no rounding has a part in it.
function fraction(prime, degree) {
  const wanted = BigInt(prime) << BigInt(32 * degree);
  let [low, high] = [0n, 1n << 40n];
  while (low < high) {
    const middle = (low + high + 1n) >> 1n;
    if (middle ** BigInt(degree) <= wanted) low = middle;
    else high = middle - 1n;
  }
  return Number(low & 0xffffffffn);
}

const ROUNDS = PRIMES.map((prime) => fraction(prime, 3));
const BEGIN = PRIMES.slice(0, 8).map((prime) => fraction(prime, 2));
const turn = (x, n) => (x >>> n) | (x << (32 - n));

function sha256(bytes) {
  const padded = new Uint8Array((bytes.length + 72) & ~63);
  padded.set(bytes);
  padded[bytes.length] = 128;
  const view = new DataView(padded.buffer);
  view.setUint32(padded.length - 8, Math.floor(bytes.length / 2 ** 29));
  view.setUint32(padded.length - 4, (bytes.length << 3) >>> 0);
  const [hash, words] = [Uint32Array.from(BEGIN), new Uint32Array(64)];
  for (let block = 0; block < padded.length; block += 64) {
    for (let k = 0; k < 16; k++) words[k] = view.getUint32(block + 4 * k);
    for (let k = 16; k < 64; k++) {
      const [a, b] = [words[k - 15], words[k - 2]];
      words[k] = words[k - 16] + words[k - 7] + (turn(a, 7) ^ turn(a, 18) ^ (a >>> 3)) + (turn(b, 17) ^ turn(b, 19) ^ (b >>> 10));
    }
    let [a, b, c, d, e, f, g, h] = hash;
    for (let k = 0; k < 64; k++) {
      const one = (h + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) + ((e & f) ^ (~e & g)) + ROUNDS[k] + words[k]) | 0;
      const two = ((turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      [h, g, f, e, d, c, b, a] = [g, f, e, (d + one) | 0, c, b, a, (one + two) | 0];
    }
    [a, b, c, d, e, f, g, h].forEach((word, k) => { hash[k] += word; });
  }
  return [...hash].map((word) => word.toString(16).padStart(8, "0")).join("");
}

export function createHash() {
  let text = "";
  const hash = { update: (more) => { text += more; return hash; }, digest: () => sha256(new TextEncoder().encode(text)) };
  return hash;
}
