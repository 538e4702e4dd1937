// How a check can end, and the work that it may take.

/** The file is no certificate (exit code 2). */
export class NoCertificate extends Error {}

/** Something that the certificate states is false (exit code 1). */
export class Refuted extends Error {}

/** Neither shown nor refuted (exit code 4). `bits` is true if sharper intervals might settle it. */
export class Undecided extends Error {
  constructor(message, bits = true) {
    super(message)
    this.bits = bits
  }
}

/** The number of bits of a whole number's magnitude, rounded up to a multiple of 4 from 64 on. */
export function bitLength(n) {
  if (n < 0n) n = -n
  if (n < 0x10000000000000n) return n === 0n ? 0 : 1 + Math.floor(Math.log2(Number(n)) + 1e-9)
  return 4 * n.toString(16).length
}

/** Counted work: a unit is about the product of two 64-bit numbers. Limits are counts, never seconds. */
export class Work {
  constructor(limit) {
    this.limit = limit
    this.spent = 0
  }

  spend(units) {
    this.spent += units
    if (this.spent > this.limit) {
      throw new Undecided(`the work allowed is spent (${this.limit.toExponential(0)} units; --work=N allows more)`, false)
    }
  }

  /** Charges for the product of numbers of so many bits. */
  product(a, b) {
    const [small, large] = a < b ? [a, b] : [b, a]
    this.spend(1 + (large / 64) * Math.sqrt(1 + small / 64))
  }
}
