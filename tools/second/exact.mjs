// The exact world: sums of fractions times products of roots. `null` is a number that is not known there.
import { malformed, undecided } from './base.mjs';

const MOST_TERMS = 4096, MOST_DIGITS = 100000;
/** Parts of a product that are kept before they are summed; and units of work that a term costs which is copied. */
const MOST_REST = 8, COPIED = 150;

/**
 * (sum of terms.get(m) * product of the roots whose bits are set in m) / den; no term is 0, den is positive.
 * Fractions are not reduced but where asked: zero is seen without.
 * @typedef {{den: bigint, terms: Map<bigint, bigint>}} Exact
 */
/** @param {bigint} n @param {bigint} [den] @returns {Exact} */
export const fraction = (n, den = 1n) => ({ den, terms: new Map(n === 0n ? [] : [[0n, n]]) });

export const ZERO = fraction(0n);

export class ExactWorld {
  /** @param {import('./base.mjs').Work} work */
  constructor(work) { this.work = work; /** @type {Exact[]} */ this.roots = []; }

  of(a) { return a; }

  /** +1, 0, -1, or undefined if not known. Roots are positive, so one term alone has the sign of its coefficient. */
  sign(a) {
    if (a === null || a.terms.size > 1) return undefined;
    for (const n of a.terms.values()) return n > 0n ? 1 : -1;
    return 0;
  }

  /** a + n b, n a whole number */
  plus(a, b, n) {
    if (a === null || b === null) return null;
    const { work } = this, same = a.den === b.den;
    if (!same) work.product(a.den, b.den);
    const terms = new Map();
    work.charge(COPIED * (a.terms.size + b.terms.size));
    for (const [m, x] of a.terms) { if (!same) work.product(x, b.den); terms.set(m, same ? x : x * b.den); }
    for (const [m, y] of b.terms) {
      work.product(y, a.den);
      const sum = (terms.get(m) ?? 0n) + n * (same ? y : y * a.den);
      if (sum === 0n) terms.delete(m); else terms.set(m, sum);
    }
    return { den: same ? a.den : a.den * b.den, terms };
  }
  add(a, b) { return this.plus(a, b, 1n); }
  sub(a, b) { return this.plus(a, b, -1n); }
  neg(a) { return this.plus(ZERO, a, -1n); }
  twice(a) { return this.plus(a, a, 1n); }
  square(a) { return this.mul(a, a); }

  mul(a, b) {
    if (a?.terms.size === 0 || b?.terms.size === 0) return ZERO; // whatever the other is
    if (a === null || b === null) return null;
    this.work.product(a.den, b.den);
    const terms = new Map(), rest = [];
    for (const [m, x] of a.terms) for (const [l, y] of b.terms) {
      this.work.product(x, y);
      const n = x * y, common = m & l;
      if (common === 0n) {
        const sum = (terms.get(m | l) ?? 0n) + n;
        if (sum === 0n) terms.delete(m | l); else terms.set(m | l, sum);
        if (terms.size > MOST_TERMS) undecided(`an exact number has more than ${MOST_TERMS} terms`);
      } else { // r_k r_k is the k-th of the roots, which has only roots before the k-th
        let p = { den: 1n, terms: new Map([[m ^ l, n]]) };
        for (let k = 0; k < this.roots.length; k++) if (common >> BigInt(k) & 1n) p = this.mul(p, this.roots[k]);
        rest.push(p);
        if (rest.length === MOST_REST) rest.push(rest.splice(0).reduce((x, y) => this.add(x, y)));
      }
    }
    const den = a.den * b.den;
    let sum = { den: 1n, terms };
    for (const p of rest) sum = this.add(sum, p);
    return { den: sum.den * den, terms: sum.terms };
  }

  /** The same number, in lowest terms. */
  reduced(a) {
    if (a === null || a.den === 1n) return a;
    let g = a.den;
    for (let x of a.terms.values()) {
      while (x !== 0n) { this.work.product(g, 1n); [g, x] = [x, g % x]; }
    }
    if (g < 0n) g = -g;
    if (a.terms.size === 0) return ZERO;
    return { den: a.den / g, terms: new Map([...a.terms].map(([m, n]) => [m, n / g])) };
  }

  /** a ** m, m > 0 */
  power(a, m) {
    if (m === 1) return a;
    const half = this.square(this.power(a, Math.floor(m / 2)));
    return m % 2 ? this.mul(half, a) : half;
  }

  /** Reads the number of a text; `roots` says how many roots it may use. @returns {Exact} */
  parse(text, roots = this.roots.length) {
    let at = 0, sum = ZERO;
    const wrong = () => malformed(`no number: ${text.slice(0, 60)}`);
    const row = () => {
      const from = at;
      while (text.charCodeAt(at) >= 48 && text.charCodeAt(at) <= 57) at++;
      if (at === from) wrong();
      if (at - from > MOST_DIGITS) malformed('a row of more than 100,000 digits');
      return BigInt(text.slice(from, at));
    };
    while (at < text.length || at === 0) {
      const sign = text[at] === '-' ? -1n : 1n;
      if (text[at] === '-' || text[at] === '+') at++; else if (at > 0) wrong();
      this.work.charge(0);
      const n = row();
      let den = 1n;
      if (text[at] === '/') { at++; den = row(); }
      if (den === 0n) malformed('a fraction over zero');
      const times = new Map(); // how often each root is a factor
      while (text[at] === '*') {
        const name = /^\*r([1-9][0-9]?)/.exec(text.slice(at, at + 4));
        if (!name) wrong();
        at += name[0].length;
        const k = Number(name[1]);
        if (k > roots) malformed(`there is no root r${k}`);
        times.set(k, (times.get(k) ?? 0) + 1);
      }
      let term = fraction(sign * n, den);
      for (const [k, m] of times) {
        if (m % 2) term = this.mul(term, { den: 1n, terms: new Map([[1n << BigInt(k - 1), 1n]]) });
        if (m > 1) term = this.mul(term, this.power(this.roots[k - 1], Math.floor(m / 2)));
      }
      sum = this.add(sum, term);
    }
    return sum;
  }

  /** Reads a decimal: its value and one unit of its last digit. @returns {{value: Exact, unit: Exact}} */
  decimal(text) {
    if (text.length > 2 * MOST_DIGITS + 2) malformed('a row of more than 100,000 digits');
    const parts = /^(-?)([0-9]+)(?:\.([0-9]+))?$/.exec(text);
    if (!parts || /\n/.test(text)) return malformed(`no decimal: ${text.slice(0, 60)}`);
    const [, minus, whole, after = ''] = parts;
    if (Math.max(whole.length, after.length) > MOST_DIGITS) malformed('a row of more than 100,000 digits');
    this.work.charge((text.length / 16) ** 2);
    const den = 10n ** BigInt(after.length), n = BigInt(whole + after);
    return { value: fraction(minus ? -n : n, den), unit: fraction(1n, den) };
  }
}
