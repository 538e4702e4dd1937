// Polynomials of degree four at most, in intervals, constant term first: where they are positive, and where one falls.
import { refute, undecided } from './base.mjs';

/** Twelve over the number of ways to choose k of n: what makes Bernstein's coefficients, twelve-fold, whole. */
const WEIGHTS = [[12n], [12n, 12n], [12n, 6n, 12n], [12n, 4n, 4n, 12n], [12n, 3n, 2n, 3n, 12n]];
const MOST_PIECES = 3000;

/** Bernstein's coefficients on [0, 1], twelve-fold, of a polynomial of whole coefficients. */
function bernstein(row) {
  let sums = row.map((x, k) => x * WEIGHTS[row.length - 1][k]);
  const out = [];
  while (sums.length) { // the j-th is the sum over k of (j over k) times the k-th
    out.push(sums[0]);
    sums = sums.slice(1).map((x, k) => x + sums[k]);
  }
  return out;
}
/** Both halves by de Casteljau, all 2 ** n-fold. */
function halves(row) {
  const left = [], right = [], n = BigInt(row.length - 1);
  for (let now = row, k = 0n; now.length; k++) {
    left.push(now[0] << (n - k));
    right.unshift(now.at(-1) << (n - k));
    now = now.slice(1).map((x, j) => x + now[j]);
  }
  return [left, right];
}

/**
 * Is a polynomial positive on [0, wait], or for ever if wait is null? 1; -1: it is negative somewhere there; undefined: not known.
 * @param {import('./interval.mjs').Interval[]} row
 */
export function keeps(row, wait, A) {
  let power = null;
  const terms = row.map(x => { // of s / wait
    const term = power ? A.mul(x, power) : x;
    if (wait) power = power ? A.mul(power, wait) : wait;
    return term;
  });
  const low = terms.map(x => x.lo), high = terms.map(x => x.hi);
  const parts = [[bernstein(low), bernstein(high)]];
  if (!wait) parts.push([bernstein(low.toReversed()), bernstein(high.toReversed())]); // from 1 on, as a function of 1 / s
  for (let count = 0; parts.length; count++) {
    const [least, most] = parts.pop();
    A.work.charge(10000 + 20 * least.length * Number(A.bits));
    if (most[0] < 0n || most.at(-1) < 0n) return -1;
    if (least[0] <= 0n || least.at(-1) <= 0n || count > MOST_PIECES) return undefined;
    if (least.every(x => x >= 0n)) continue;
    const [a, b] = halves(least), [c, d] = halves(most);
    parts.push([a, c], [b, d]);
  }
  return 1;
}

/** A polynomial over x - s, where it is zero at x. */
export function divided(row, x, A) {
  const out = [A.neg(row.at(-1))];
  for (let k = row.length - 2; k > 0; k--) out.unshift(A.sub(A.mul(x, out[0]), row[k]));
  return out;
}

const horner = (row, x, A) => row.slice(0, -1).reduceRight((sum, term) => A.add(A.mul(sum, x), term), row.at(-1));

/** The one zero between low and high, two intervals, of a polynomial that falls all along between them. */
export function falling(row, low, high, A, what) {
  const slope = row.slice(1).map((x, k) => ({ lo: x.lo * BigInt(k + 1), hi: x.hi * BigInt(k + 1) }));
  let x = { lo: low.lo, hi: high.hi };
  if (x.lo > x.hi || !(A.sign(horner(slope, x, A)) < 0)) undecided(`whether ${what} falls all the time that is told`);
  for (const [end, wanted] of [[low, 1], [high, -1]]) {
    const s = A.sign(horner(row, end, A)) ?? undecided(`whether ${what} hits when it is told`);
    if (s !== wanted) refute(`${what} does not fall through zero when it is told`);
  }
  for (;;) { // Newton: each meets all that is between
    const middle = (x.lo + x.hi) >> 1n, at = { lo: middle, hi: middle };
    const step = A.div(horner(row, at, A), horner(slope, x, A)) ?? undecided(`when ${what} hits`);
    const next = A.sub(at, step), lo = next.lo > x.lo ? next.lo : x.lo, hi = next.hi < x.hi ? next.hi : x.hi;
    if (lo > hi) undecided(`when ${what} hits`);
    if (hi - lo >= x.hi - x.lo) return x;
    x = { lo, hi };
  }
}
