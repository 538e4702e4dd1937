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

/** Thrown where the limit of work is exceeded: never a verdict on the certificate. */
export class TooMuch extends Verdict {
  constructor(limit) { super(4, `more than ${limit} units of work (--work)`); }
}

const POWERS = [1n << 64n]; // 2 ** (64 * 2 ** k)
/** Length of a big number in words of 64 bits, rounded up to a power of two. Comparing two lengths takes no time. */
export function words(x) {
  for (let k = 0; ; k++) {
    const power = POWERS[k] ??= POWERS[k - 1] ** 2n;
    if (x < power && x > -power) return 2 ** k;
  }
}

/** Work is counted, not timed: about one unit for each product of two words, 64 for each operation. */
const EACH = 64;

export class Work {
  constructor(limit) { this.limit = limit; this.done = 0; }
  /** To be called before the work is done. */
  charge(units) { this.done += EACH + units; if (this.done > this.limit) throw new TooMuch(this.limit); }
  /** Before a * b. */
  product(a, b) { this.charge(words(a) * words(b)); }
}
