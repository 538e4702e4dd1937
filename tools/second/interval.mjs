// The world of intervals [lo, hi] / 2**bits, rounded outward.
import { times, words } from './base.mjs';

/** @typedef {{lo: bigint, hi: bigint}} Interval */

/** The quotients by d > 0, rounded down and up (BigInt's own rounds towards zero). */
const floorDiv = (n, d) => { const q = n / d; return n < 0n && q * d !== n ? q - 1n : q; };
const ceilDiv = (n, d) => -floorDiv(-n, d);

export class IntervalWorld {
  /** @param {number} bits @param {import('./base.mjs').Work} work */
  constructor(bits, work) {
    this.bits = BigInt(bits);
    this.work = work;
    this.zero = { lo: 0n, hi: 0n };
    this.usual = 1n << BigInt(bits + 64); // numbers up to here are charged alike, without being measured
    this.price = 2 * times((bits >> 6) + 1, (bits >> 6) + 1);
    this.least = bits >> 2; // of a sum
    /** @type {Interval[]} the square roots r1, r2, ... */ this.roots = [];
    /** @type {Map<bigint, Interval>} their products */ this.products = new Map();
  }

  charge(a, b) {
    const { usual, work } = this;
    if (a.lo > -usual && a.hi < usual && b.lo > -usual && b.hi < usual) work.charge(this.price);
    else work.charge(times(words(a.lo) + words(a.hi), words(b.lo) + words(b.hi)));
  }

  /** +1, 0, -1, or undefined if not known */
  sign(a) { return a === null ? undefined : a.lo > 0n ? 1 : a.hi < 0n ? -1 : a.lo === 0n && a.hi === 0n ? 0 : undefined; }

  add(a, b) { this.work.charge(this.least); return { lo: a.lo + b.lo, hi: a.hi + b.hi }; }
  sub(a, b) { this.work.charge(this.least); return { lo: a.lo - b.hi, hi: a.hi - b.lo }; }
  neg(a) { return { lo: -a.hi, hi: -a.lo }; }
  twice(a) { return { lo: a.lo * 2n, hi: a.hi * 2n }; }

  /** From 2 * bits after the point to bits. */
  round(lo, hi) { return { lo: lo >> this.bits, hi: -(-hi >> this.bits) }; } // >> rounds down

  mul(a, b) {
    this.charge(a, b);
    if (a.lo >= 0n) {
      return this.round((b.lo >= 0n ? a.lo : a.hi) * b.lo, (b.hi >= 0n ? a.hi : a.lo) * b.hi);
    }
    if (a.hi <= 0n) {
      return this.round((b.hi >= 0n ? a.lo : a.hi) * b.hi, (b.lo >= 0n ? a.hi : a.lo) * b.lo);
    }
    if (b.lo >= 0n) return this.round(a.lo * b.hi, a.hi * b.hi);
    if (b.hi <= 0n) return this.round(a.hi * b.lo, a.lo * b.lo);
    const p = a.lo * b.hi, q = a.hi * b.lo, r = a.lo * b.lo, s = a.hi * b.hi;
    return this.round(p < q ? p : q, r > s ? r : s);
  }

  square(a) {
    if (a.lo >= 0n || a.hi <= 0n) return this.mul(a, a);
    this.charge(a, a);
    const far = -a.lo > a.hi ? -a.lo : a.hi;
    return this.round(0n, far * far);
  }

  /** null if the divisor is not known to be other than zero */
  div(a, b) {
    if (b.hi < 0n) return this.div(this.neg(a), this.neg(b));
    if (b.lo <= 0n) return null;
    for (let k = 0; k < 3; k++) this.charge(a, b);
    return {
      lo: floorDiv(a.lo << this.bits, a.lo >= 0n ? b.hi : b.lo),
      hi: ceilDiv(a.hi << this.bits, a.hi >= 0n ? b.lo : b.hi),
    };
  }

  /** of a positive interval */
  sqrt(a) {
    const hi = this.isqrt(a.hi << this.bits);
    return { lo: this.isqrt(a.lo << this.bits), hi: hi * hi === a.hi << this.bits ? hi : hi + 1n };
  }

  /** The whole square root, rounded down, of a whole number: Newton's method from above, where half the digits of n lead to. */
  isqrt(n) {
    if (n < 2n) return n;
    const half = BigInt(n.toString(16).length); // of its bits, by four
    let x = half < 4n ? n : (this.isqrt(n >> 2n * half) + 1n) << half; // over the root; it falls until it is there
    for (;;) {
      for (let k = 0; k < 3; k++) this.work.product(x, x);
      const y = (x + n / x) >> 1n;
      if (y >= x) return x;
      x = y;
    }
  }

  /** A narrow enclosure of an exact number. @param {import('./exact.mjs').Exact} e @returns {Interval} */
  of(e) {
    if (e === null) return null;
    let lo = 0n, hi = 0n;
    for (const [mask, n] of e.terms) {
      const r = this.product(mask);
      this.work.product(n, r.hi);
      const [p, q] = [n * r.lo, n * r.hi];
      lo += n > 0n ? p : q;
      hi += n > 0n ? q : p;
    }
    this.work.product(hi, e.den); this.work.product(lo, e.den);
    return { lo: floorDiv(lo, e.den), hi: ceilDiv(hi, e.den) };
  }

  /** The product of the roots in a mask. */
  product(mask) {
    let p = this.products.get(mask);
    if (!p) {
      p = { lo: 1n << this.bits, hi: 1n << this.bits };
      this.roots.forEach((r, k) => { if (mask >> BigInt(k) & 1n) p = this.mul(p, r); });
      this.products.set(mask, p);
    }
    return p;
  }

  /** The interval of a world of more bits, rounded outward. */
  from(a, bits) { const s = bits - this.bits; return a && { lo: a.lo >> s, hi: -(-a.hi >> s) }; }
}
