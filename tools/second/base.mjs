// Verdicts, and the count of work.

/** What ends a check early. code: 1 refuted, 2 no certificate, 4 not decided. */
export class Verdict extends Error {
  /** @param {1|2|4} code @param {string} text */
  constructor(code, text) { super(text); this.code = code; }
}
/** @returns {never} */
export const refute = text => { throw new Verdict(1, text); };
/** @returns {never} */
export const malformed = text => { throw new Verdict(2, text); };
/** @returns {never} */
export const undecided = text => { throw new Verdict(4, text); };

/** Thrown where a limit of cost is exceeded: never a verdict on the certificate. */
export class TooMuch extends Verdict {
  constructor(limit, what) { super(4, `costs more than ${limit} ${what}; --work=N`); }
}

const POWERS = [1n << 64n]; // 2 ** (64 * 2 ** k)
/** Length of a big number in words of 64 bits, rounded up to a power of two. Comparing two lengths takes no time. */
export function words(x) {
  for (let k = 0; ; k++) {
    const power = POWERS[k] ??= POWERS[k - 1] ** 2n;
    if (x < power && x > -power) return 2 ** k;
  }
}

/**
 * What a product of numbers of so many words costs: V8 multiplies by Karatsuba's method, and large ones by better ones.
 * @param {number} a @param {number} b
 */
export const times = (a, b) => 7 * Math.max(a, b) * Math.min(a, b) ** 0.55;

/** Work is counted, not timed, in units of about a nanosecond; each operation costs so many, and what its numbers cost. */
const EACH = 250, MOST_WORK = 14e9, MOST_WORK_A_BYTE = 32000, MOST_BYTES = 2e8;

/** One account over all that is tried with a file: what is done, and what is kept. */
export class Work {
  /** @param {number} [limit] if it is left out, by the size of the file, in bytes, and what is kept has a limit too */
  constructor(limit, size = 0) {
    this.limit = limit ?? MOST_WORK + MOST_WORK_A_BYTE * size;
    this.room = limit === undefined ? MOST_BYTES : Infinity;
    this.done = 0;
    this.kept = 0;
  }
  /** To be called before the work is done. */
  charge(units) { this.done += EACH + units; if (this.done > this.limit) throw new TooMuch(this.limit, 'units of work'); }
  /** So many bytes are kept from now on. */
  keep(bytes) { this.kept += bytes; if (this.kept > this.room) throw new TooMuch(this.room, 'bytes'); }
  /** Before a * b. */
  product(a, b) { this.charge(times(words(a), words(b))); }
}
