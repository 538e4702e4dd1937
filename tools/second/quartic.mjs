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
 * Is one of some polynomials positive at each time of [0, wait], or for ever if wait is null? 1; -1: it is seen that they are not; undefined: not known.
 * Of one alone it is seen where that is negative. Of more, the first one's opposite among them, where that goes from above zero to below, while the fourth, if
 * there is one, is negative.
 * @param {import('./interval.mjs').Interval[][]} rows
 */
export function keeps(rows, wait, A) {
  const scaled = row => {
    let power = null;
    return row.map(x => { // of s / wait
      const term = power ? A.mul(x, power) : x;
      if (wait) power = power ? A.mul(power, wait) : wait;
      return term;
    });
  };
  const terms = rows.map(scaled), sides = turn => terms.map(row => ['lo', 'hi'].map(side => bernstein(turn(row.map(x => x[side])))));
  const parts = [[sides(x => x), false]];
  if (!wait) parts.push([sides(x => x.toReversed()), true]); // from 1 on, as functions of 1 / s
  for (let count = 0; parts.length; count++) {
    const [all, back] = parts.pop();
    for (const [least] of all) A.work.charge(10000 + 20 * least.length * Number(A.bits));
    if (all.some(([least]) => least[0] > 0n && least.at(-1) > 0n && least.every(x => x >= 0n))) continue;
    const [least, most] = all[0], [start, end] = back ? [least.at(-1), most[0]] : [least[0], most.at(-1)];
    if (all.length === 1 && (most[0] < 0n || most.at(-1) < 0n)) return -1;
    if (all.length > 1 && start > 0n && end < 0n && all.slice(3).every(([, row]) => row.every(x => x < 0n))) return -1;
    const bare = at => all.every(([row]) => row.at(at) <= 0n);
    if (bare(0) || bare(-1) || count > MOST_PIECES) return undefined;
    const split = all.map(pair => pair.map(halves));
    for (const half of [0, 1]) parts.push([split.map(pair => pair.map(both => both[half])), back]);
  }
  return 1;
}

/** The derivative of a polynomial. */
export const slope = row => row.slice(1).map((x, k) => ({ lo: x.lo * BigInt(k + 1), hi: x.hi * BigInt(k + 1) }));

/** A polynomial over x - s, where it is zero at x. */
export function divided(row, x, A) {
  const out = [A.neg(row.at(-1))];
  for (let k = row.length - 2; k > 0; k--) out.unshift(A.sub(A.mul(x, out[0]), row[k]));
  return out;
}

export const horner = (row, x, A) => row.slice(0, -1).reduceRight((sum, term) => A.add(A.mul(sum, x), term), row.at(-1));

/** The one zero between low and high, two intervals, of a polynomial that falls all along between them. */
export function falling(row, low, high, A, what) {
  const down = slope(row);
  let x = { lo: low.lo, hi: high.hi };
  if (x.lo > x.hi || !(A.sign(horner(down, x, A)) < 0)) undecided(`whether ${what} falls all the time that is told`);
  for (const [end, wanted] of [[low, 1], [high, -1]]) {
    const s = A.sign(horner(row, end, A)) ?? undecided(`whether ${what} hits when it is told`);
    if (s !== wanted) refute(`${what} does not fall through zero when it is told`);
  }
  for (;;) { // Newton: each meets all that is between
    const middle = (x.lo + x.hi) >> 1n, at = { lo: middle, hi: middle };
    const step = A.div(horner(row, at, A), horner(down, x, A)) ?? undecided(`when ${what} hits`);
    const next = A.sub(at, step), lo = next.lo > x.lo ? next.lo : x.lo, hi = next.hi < x.hi ? next.hi : x.hi;
    if (lo > hi) undecided(`when ${what} hits`);
    if (hi - lo >= x.hi - x.lo) return x;
    x = { lo, hi };
  }
}
