// The Mersenne Twister MT19937 (Matsumoto and Nishimura 1998), started by `init_by_array`.

const N = 624
const M = 397

/** Uniform choices as `sequential:seed=N` draws them. */
export class Twister {
  constructor(seed) {
    const key = []
    for (let rest = BigInt(seed); rest > 0n; rest >>= 32n) key.push(Number(rest & 0xffffffffn))
    if (!key.length) key.push(0)
    const s = new Uint32Array(N)
    s[0] = 19650218
    for (let i = 1; i < N; i++) s[i] = Math.imul(1812433253, s[i - 1] ^ (s[i - 1] >>> 30)) + i
    let i = 1
    let j = 0
    for (let k = Math.max(N, key.length); k > 0; k--) {
      s[i] = (s[i] ^ Math.imul(s[i - 1] ^ (s[i - 1] >>> 30), 1664525)) + key[j] + j
      if (++i >= N) {
        s[0] = s[N - 1]
        i = 1
      }
      if (++j >= key.length) j = 0
    }
    for (let k = N - 1; k > 0; k--) {
      s[i] = (s[i] ^ Math.imul(s[i - 1] ^ (s[i - 1] >>> 30), 1566083941)) - i
      if (++i >= N) {
        s[0] = s[N - 1]
        i = 1
      }
    }
    s[0] = 0x80000000
    this.state = s
    this.at = N
  }

  /** The next 32-bit output. */
  next() {
    const s = this.state
    if (this.at === N) {
      for (let k = 0; k < N; k++) {
        const y = (s[k] & 0x80000000) | (s[(k + 1) % N] & 0x7fffffff)
        s[k] = s[(k + M) % N] ^ (y >>> 1) ^ (y & 1 ? 0x9908b0df : 0)
      }
      this.at = 0
    }
    let y = s[this.at++]
    y ^= y >>> 11
    y ^= (y << 7) & 0x9d2c5680
    y ^= (y << 15) & 0xefc60000
    y ^= y >>> 18
    return y >>> 0
  }

  /** A place from 0 to k - 1, k > 1. */
  below(k) {
    const bits = 32 - Math.clz32(k)
    for (;;) {
      const drawn = this.next() >>> (32 - bits)
      if (drawn < k) return drawn
    }
  }
}
