// Real numbers enclosed in fixed point: {m, r} stands for the numbers within r of m, both in units of 2**-bits.
//
// Each operation encloses all results that its operands allow. Where r = 0 the number is known exactly.

import { Undecided, bitLength } from './outcome.mjs'

const abs = (n) => (n < 0n ? -n : n)

/** The whole part of a square root. */
export function wholeRoot(n) {
  if (n < 2n) return n
  const c = Math.floor((bits(n) - 1) / 2)
  let a = 1n
  let d = 0
  for (let s = Math.floor(Math.log2(Math.max(c, 1))) + 1; s >= 0; s--) {
    const e = d
    d = Math.floor(c / 2 ** s)
    if (d === e) continue
    a = (a << BigInt(d - e - 1)) + (n >> BigInt(2 * c - e - d + 1)) / a
  }
  while (a * a > n) a--
  while ((a + 1n) * (a + 1n) <= n) a++
  return a
}

function bits(n) {
  const text = n.toString(16)
  return 4 * (text.length - 1) + 32 - Math.clz32(parseInt(text[0], 16))
}

/** -1, 0 or 1, or undefined where it is not known. */
export function sign(x) {
  if (x.m > x.r) return 1
  if (x.m < -x.r) return -1
  return x.m === 0n && x.r === 0n ? 0 : undefined
}

export const lower = (x) => x.m - x.r
export const upper = (x) => x.m + x.r
export const apart = (x, y) => abs(x.m - y.m) > x.r + y.r
export const sameSingle = (x, y) => x.r === 0n && y.r === 0n && x.m === y.m
export const isZero = (x) => x.m === 0n && x.r === 0n

/** Arithmetic with so many bits after the binary point. */
export class Fixed {
  constructor(bits, work) {
    this.bits = bits
    this.shift = BigInt(bits)
    this.work = work
    this.cost = 2 + (bits / 64) ** 1.5 / 4
    this.zero = { m: 0n, r: 0n }
  }

  whole(n) {
    return { m: BigInt(n) << this.shift, r: 0n }
  }

  fraction(n, d) {
    this.work.product(bitLength(n) + this.bits, bitLength(d))
    const scaled = n << this.shift
    const m = scaled / d
    return { m, r: m * d === scaled ? 0n : 1n }
  }

  /** The same number, given with other bits. */
  from(x, bits) {
    return this.shifted(x, BigInt(this.bits - bits))
  }

  add(x, y) {
    return { m: x.m + y.m, r: x.r + y.r }
  }

  sub(x, y) {
    return { m: x.m - y.m, r: x.r + y.r }
  }

  neg(x) {
    return { m: -x.m, r: x.r }
  }

  twice(x) {
    return { m: x.m << 1n, r: x.r << 1n }
  }

  /** x times 2**n. */
  shifted(x, n) {
    if (n >= 0n) return { m: x.m << n, r: x.r << n }
    const m = x.m >> -n
    return { m, r: -(-x.r >> -n) + (m << -n === x.m ? 0n : 1n) }
  }

  mul(x, y) {
    if (isZero(x) || isZero(y)) return this.zero
    this.work.spend(this.cost)
    const product = x.m * y.m
    const m = product >> this.shift
    let r = m << this.shift === product ? 0n : 1n
    if (x.r !== 0n || y.r !== 0n) {
      const spread = abs(x.m) * y.r + abs(y.m) * x.r + x.r * y.r
      r += (spread >> this.shift) + 1n
    }
    return { m, r }
  }

  square(x) {
    return this.mul(x, x)
  }

  dot(a, b, c, d) {
    return this.add(this.mul(a, c), this.mul(b, d))
  }

  div(x, y) {
    const least = abs(y.m) - y.r
    if (least <= 0n) throw new Undecided('a divisor may be zero')
    if (isZero(x)) return this.zero
    this.work.spend(3 * this.cost)
    const scaled = x.m << this.shift
    const m = scaled / y.m
    let r = m * y.m === scaled ? 0n : 1n
    if (x.r !== 0n || y.r !== 0n) r += ((x.r << this.shift) + (abs(m) + 1n) * y.r) / least + 1n
    return { m, r }
  }

  /** The positive root of a number above zero. */
  sqrt(x) {
    if (x.m <= x.r) throw new Undecided('a radicand may be zero')
    this.work.spend(8 * this.cost)
    const scaled = x.m << this.shift
    const m = wholeRoot(scaled)
    let r = m * m === scaled ? 0n : 1n
    if (x.r !== 0n) r += (x.r << this.shift) / m + 1n // sqrt(x) - sqrt(x - r) <= r / sqrt(x)
    return { m, r }
  }
}
