// Mersenne Twister MT19937 (Matsumoto and Nishimura, 1998), as sequential:seed=N draws from it. 32-bit words only.

export class Random {
  /** init_by_array with the seed's words of 32 bits, least first @param {bigint} seed */
  constructor(seed) {
    const key = [];
    do { key.push(Number(seed & 0xffffffffn)); seed >>= 32n; } while (seed);
    const s = this.state = new Uint32Array(624);
    s[0] = 19650218;
    for (let i = 1; i < 624; i++) s[i] = Math.imul(1812433253, s[i - 1] ^ (s[i - 1] >>> 30)) + i;
    let i = 1, j = 0;
    const next = () => { if (++i === 624) { s[0] = s[623]; i = 1; } };
    for (let k = Math.max(624, key.length); k; k--) {
      s[i] = (s[i] ^ Math.imul(s[i - 1] ^ (s[i - 1] >>> 30), 1664525)) + key[j] + j;
      next();
      j = (j + 1) % key.length;
    }
    for (let k = 623; k; k--) {
      s[i] = (s[i] ^ Math.imul(s[i - 1] ^ (s[i - 1] >>> 30), 1566083941)) - i;
      next();
    }
    s[0] = 0x80000000;
    this.at = 624;
  }

  word() {
    const s = this.state;
    if (this.at === 624) {
      for (let k = 0; k < 624; k++) {
        const y = (s[k] & 0x80000000) | (s[(k + 1) % 624] & 0x7fffffff);
        s[k] = s[(k + 397) % 624] ^ (y >>> 1) ^ (y & 1 ? 0x9908b0df : 0);
      }
      this.at = 0;
    }
    let y = s[this.at++];
    y ^= y >>> 11;
    y ^= (y << 7) & 0x9d2c5680;
    y ^= (y << 15) & 0xefc60000;
    return (y ^ (y >>> 18)) >>> 0;
  }

  /** randrange(k), k > 1 */
  below(k) {
    const shift = Math.clz32(k);
    for (;;) { const x = this.word() >>> shift; if (x < k) return x; }
  }
}
