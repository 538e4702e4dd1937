// Exact numbers: fractions and square roots in a tower of quadratic extensions, kept in normal form.
//
// A number is {t, d}: an integral part t over a positive whole number d. An integral part is a BigInt, or {k, a, b} for
// a + b sqrt(D_k), where D_k is the radicand of root k, a and b hold roots before k only, and b is not zero. A root is
// added to the tower only if its radicand has none there already; therefore 1 and sqrt(D_k) are linearly independent
// over what comes before, the form is unique, and a number is zero if and only if its form is 0.

import { Fixed, sign, wholeRoot } from './interval.mjs'
import { Undecided, bitLength } from './outcome.mjs'

const MAX_ROOTS = 16
const MAX_BITS = 1 << 20

export const ZERO = { t: 0n, d: 1n }
export const ONE = { t: 1n, d: 1n }
export const whole = (n) => ({ t: BigInt(n), d: 1n })
export const exactlyZero = (x) => x.t === 0n

const level = (t) => (typeof t === 'bigint' ? -1 : t.k)
const make = (k, a, b) => (b === 0n ? a : { k, a, b })

function negated(t) {
  return typeof t === 'bigint' ? -t : { k: t.k, a: negated(t.a), b: negated(t.b) }
}

function* coefficients(t) {
  if (typeof t === 'bigint') yield t
  else {
    yield* coefficients(t.a)
    yield* coefficients(t.b)
  }
}

/** The greatest common divisor, by Lehmer's method: most quotients are read off the leading 52 bits. */
export function gcd(a, b) {
  if (a < b) [a, b] = [b, a]
  while (b > 0xfffffffffffffn) {
    const drop = BigInt(4 * a.toString(16).length - 52)
    let [x, y] = [Number(a >> drop), Number(b >> drop)]
    let [p, q, r, s] = [1, 0, 0, 1]
    let steps = 0
    for (; y !== r; steps++) {
      const quotient = Math.floor((x + (p - 1)) / (y - r))
      const [t, rest] = [q + quotient * s, x - quotient * y]
      if (t > rest) break
      ;[x, y] = [y, rest]
      ;[p, q, r, s] = [s, r, t, p + quotient * r]
    }
    const [A, B, C, D] = [p, q, r, s].map(BigInt)
    if (steps === 0) [a, b] = [b, a % b]
    else if (steps % 2) [a, b] = [A * b - B * a, D * a - C * b]
    else [a, b] = [A * a - B * b, D * b - C * a]
  }
  while (b !== 0n) [a, b] = [b, a % b]
  return a
}

/** A tower over the fractions. Towers are copied where a question needs roots of its own. */
export class Tower {
  constructor(work, roots = []) {
    this.work = work
    this.roots = roots
  }

  copy() {
    return new Tower(this.work, [...this.roots])
  }

  // Integral parts

  #plus(s, t) {
    if (typeof s === 'bigint' && typeof t === 'bigint') return s + t
    const [i, j] = [level(s), level(t)]
    if (i === j) return make(i, this.#plus(s.a, t.a), this.#plus(s.b, t.b))
    return i > j ? { k: i, a: this.#plus(s.a, t), b: s.b } : { k: j, a: this.#plus(s, t.a), b: t.b }
  }

  #times(s, t) {
    if (s === 0n || t === 0n) return 0n
    if (typeof s === 'bigint' && typeof t === 'bigint') {
      this.work.product(bitLength(s), bitLength(t))
      return s * t
    }
    const [i, j] = [level(s), level(t)]
    if (i > j) return { k: i, a: this.#times(s.a, t), b: this.#times(s.b, t) }
    if (i < j) return { k: j, a: this.#times(s, t.a), b: this.#times(s, t.b) }
    const square = this.#times(this.#times(s.b, t.b), this.roots[i])
    const cross = this.#plus(this.#times(s.a, t.b), this.#times(s.b, t.a))
    return make(i, this.#plus(this.#times(s.a, t.a), square), cross)
  }

  #reduced(t, d) {
    if (d < 0n) [t, d] = [negated(t), -d]
    if (t === 0n) return ZERO
    let common = d
    for (const c of coefficients(t)) {
      if (common === 1n) break
      common = this.#gcd(common, c < 0n ? -c : c)
    }
    if (bitLength(d) > MAX_BITS) throw new Undecided('an exact number grows too long', false)
    return common === 1n ? { t, d } : { t: divided(t, common), d: d / common }
  }

  #gcd(a, b) {
    const [m, n] = [bitLength(a), bitLength(b)]
    const small = Math.min(m, n)
    this.work.spend(1 + (small * (1 + small / 4096) + Math.abs(m - n)) / 32)
    return gcd(a, b)
  }

  // Numbers

  fraction(n, d) {
    return this.#reduced(n, d)
  }

  add(x, y) {
    if (x.t === 0n) return y
    if (y.t === 0n) return x
    if (x.d === y.d) return this.#reduced(this.#plus(x.t, y.t), x.d)
    return this.#reduced(this.#plus(this.#times(x.t, y.d), this.#times(y.t, x.d)), x.d * y.d)
  }

  neg(x) {
    return { t: negated(x.t), d: x.d }
  }

  sub(x, y) {
    return this.add(x, this.neg(y))
  }

  mul(x, y) {
    if (x.t === 0n || y.t === 0n) return ZERO
    return this.#reduced(this.#times(x.t, y.t), x.d * y.d)
  }

  dot(a, b, c, d) {
    return this.add(this.mul(a, c), this.mul(b, d))
  }

  inverse(x) {
    if (x.t === 0n) throw new Undecided('an exact divisor is zero', false)
    if (typeof x.t === 'bigint') return this.#reduced(x.d, x.t)
    const { k, a, b } = x.t // d / (a + b sqrt(D)) = d (a - b sqrt(D)) / (a a - b b D)
    const norm = this.#plus(this.#times(a, a), negated(this.#times(this.#times(b, b), this.roots[k])))
    const part = this.inverse({ t: norm, d: 1n })
    return this.mul({ t: this.#times({ k, a, b: negated(b) }, x.d), d: 1n }, part)
  }

  div(x, y) {
    return x.t === 0n ? ZERO : this.mul(x, this.inverse(y))
  }

  equal(x, y) {
    return exactlyZero(this.sub(x, y))
  }

  // Square roots

  /** The positive root of a positive number; it is added to the tower if the tower does not hold it. */
  sqrt(x) {
    if (x.t === 0n) return ZERO
    if (this.sign(x) < 0) throw new Undecided('an exact radicand is negative', false)
    const root = this.#rootWithin(x, this.roots.length - 1)
    if (root) return this.sign(root) < 0 ? this.neg(root) : root
    if (this.roots.length === MAX_ROOTS) throw new Undecided(`more than ${MAX_ROOTS} square roots are needed`, false)
    this.roots.push(this.#times(x.t, x.d)) // sqrt(t / d) = sqrt(t d) / d
    return this.#reduced({ k: this.roots.length - 1, a: 0n, b: 1n }, x.d)
  }

  /** A root of x among the numbers with roots up to k, or null if there is none. */
  #rootWithin(x, k) {
    this.work.spend(1)
    if (x.t === 0n) return ZERO
    if (k < 0) return this.#rationalRoot(x)
    if (level(x.t) < k) {
      const plain = this.#rootWithin(x, k - 1)
      if (plain) return plain
      const beside = this.#rootWithin(this.div(x, { t: this.roots[k], d: 1n }), k - 1)
      return beside && this.mul(beside, { t: { k, a: 0n, b: 1n }, d: 1n })
    }
    const a = this.#reduced(x.t.a, x.d)
    const b = this.#reduced(x.t.b, x.d)
    const norm = this.sub(this.mul(a, a), this.mul(this.mul(b, b), { t: this.roots[k], d: 1n }))
    const n = this.#rootWithin(norm, k - 1)
    if (!n) return null
    for (const m of [n, this.neg(n)]) {
      const c = this.#rootWithin(this.mul(this.add(a, m), { t: 1n, d: 2n }), k - 1)
      if (c && c.t !== 0n) {
        const e = this.div(b, this.add(c, c))
        return this.add(c, this.mul(e, { t: { k, a: 0n, b: 1n }, d: 1n }))
      }
    }
    return null
  }

  #rationalRoot(x) {
    if (x.t < 0n) return null
    this.work.product(bitLength(x.t), bitLength(x.t))
    const n = wholeRoot(x.t)
    if (n * n !== x.t) return null
    const d = wholeRoot(x.d)
    return d * d === x.d ? { t: n, d } : null
  }

  // Signs and enclosures

  sign(x) {
    if (x.t === 0n) return 0
    if (typeof x.t === 'bigint') return x.t > 0n ? 1 : -1
    for (let bits = 64; ; bits *= 2) {
      const found = sign(this.enclose(x, new Fixed(bits, this.work)))
      if (found) return found
      if (bits > MAX_BITS) throw new Undecided('the sign of an exact number takes too many bits', false)
    }
  }

  /** An interval that holds x, in the given arithmetic. */
  enclose(x, fixed) {
    if (typeof x.t === 'bigint') return fixed.fraction(x.t, x.d)
    const guard = 32 + bitLength(x.d)
    let finest = 0
    for (const c of coefficients(x.t)) finest = Math.max(finest, bitLength(c))
    const wide = new Fixed(fixed.bits + guard + finest, this.work)
    const roots = []
    const value = (t) => {
      if (typeof t === 'bigint') return wide.whole(t)
      if (!roots[t.k]) roots[t.k] = this.#rootEnclosure(t.k, wide, value)
      return wide.add(value(t.a), wide.mul(value(t.b), roots[t.k]))
    }
    const exact = value(x.t)
    return fixed.from(wide.div(exact, wide.whole(x.d)), wide.bits)
  }

  #rootEnclosure(k, wide, value) {
    for (let bits = wide.bits; ; bits *= 2) {
      // A radicand is positive, but may be small.
      const finer = bits === wide.bits ? wide : new Fixed(bits, this.work)
      const radicand = finer === wide ? value(this.roots[k]) : this.enclose({ t: this.roots[k], d: 1n }, finer)
      if (sign(radicand) === 1) return wide.from(finer.sqrt(radicand), bits)
      if (bits > MAX_BITS) throw new Undecided('the sign of a radicand takes too many bits', false)
    }
  }
}

function divided(t, n) {
  return typeof t === 'bigint' ? t / n : { k: t.k, a: divided(t.a, n), b: divided(t.b, n) }
}
