// Exact numbers: sums of fractions times products of the roots of a certificate. They are only added and multiplied.
//
// A form is {d, terms}: `terms` maps a set of roots, bit k for root k, to a whole number, over the common denominator d.
// UNTOLD stands for a number that takes a division or a root and is not told: nothing is known of it.

import { bitLength } from './outcome.mjs'

export const UNTOLD = null
const LONG = 2000 // bits of a denominator from which on common factors are looked for

const form = (d, terms) => ({ d, terms })
export const ZERO = form(1n, new Map())
export const ONE = form(1n, new Map([[0n, 1n]]))

/** A fraction as a form. */
export const fraction = (n, d = 1n) => (n === 0n ? ZERO : form(d, new Map([[0n, n]])))

/** Whether a form has no terms, and so is zero, whatever the roots are. */
export const isNone = (x) => x !== UNTOLD && x.terms.size === 0

function gcd(a, b) {
  while (b) [a, b] = [b, a % b]
  return a < 0n ? -a : a
}

function tidy(d, terms) {
  for (const [key, n] of terms) if (n === 0n) terms.delete(key)
  if (terms.size === 0) return ZERO
  if (bitLength(d) < LONG) return form(d, terms)
  let common = d
  for (const n of terms.values()) common = gcd(n, common)
  if (common === 1n) return form(d, terms)
  return form(d / common, new Map([...terms].map(([key, n]) => [key, n / common])))
}

/** The arithmetic of forms over a list of roots, whose squares are forms in earlier ones. */
export class Forms {
  constructor(work) {
    this.work = work
    this.squares = []
    this.zero = ZERO
  }

  /** Root k as a form. */
  root(k) {
    return k < this.squares.length ? form(1n, new Map([[1n << BigInt(k), 1n]])) : undefined
  }

  of(x) {
    return x
  }

  neg(x) {
    return x === UNTOLD ? UNTOLD : form(x.d, new Map([...x.terms].map(([key, n]) => [key, -n])))
  }

  add(x, y) {
    if (x === UNTOLD || y === UNTOLD) return UNTOLD
    const terms = new Map([...x.terms].map(([key, n]) => [key, n * y.d]))
    this.work.product(bitLength(x.d), bitLength(y.d))
    for (const [key, n] of y.terms) terms.set(key, (terms.get(key) ?? 0n) + n * x.d)
    return tidy(x.d * y.d, terms)
  }

  sub(x, y) {
    return this.add(x, this.neg(y))
  }

  twice(x) {
    return this.add(x, x)
  }

  mul(x, y) {
    if (isNone(x) || isNone(y)) return ZERO
    if (x === UNTOLD || y === UNTOLD) return UNTOLD
    const parts = new Map() // by the roots that both terms have
    for (const [j, n] of x.terms) {
      for (const [k, m] of y.terms) {
        this.work.product(bitLength(n), bitLength(m))
        if (!parts.has(j & k)) parts.set(j & k, new Map())
        const part = parts.get(j & k)
        part.set(j ^ k, (part.get(j ^ k) ?? 0n) + n * m)
      }
    }
    let sum = ZERO
    for (const [common, terms] of parts) {
      let term = tidy(x.d * y.d, terms)
      for (let k = 0; common >> BigInt(k) > 0n; k++) {
        if ((common >> BigInt(k)) & 1n) term = this.mul(term, this.squares[k])
      }
      sum = this.add(sum, term)
    }
    return sum
  }

  div() {
    return UNTOLD
  }

  sqrt() {
    return UNTOLD
  }
}

/** Intervals, with the same operations: `fixed` is a Fixed. */
export class Balls {
  constructor(fixed) {
    this.fixed = fixed
    this.roots = []
    this.zero = fixed.zero
    for (const name of ['neg', 'add', 'sub', 'twice', 'mul', 'div', 'sqrt']) {
      this[name] = fixed[name].bind(fixed)
    }
  }

  /** The interval of a form. None but zero is of one number alone: what is equal is shown by forms. */
  of({ d, terms }) {
    let sum = { m: 0n, r: terms.size ? 1n : 0n }
    for (const [key, n] of terms) {
      let term = this.fixed.fraction(n, d)
      for (let k = 0; key >> BigInt(k) > 0n; k++) if ((key >> BigInt(k)) & 1n) term = this.fixed.mul(term, this.roots[k])
      sum = this.fixed.add(sum, term)
    }
    return sum
  }
}
