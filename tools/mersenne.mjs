// Python's generator: MT19937 started by an array, and `randrange`.

export class Mersenne {
  constructor(seed) {
    const words = [];
    do { words.push(Number(seed & 0xffffffffn)); seed >>= 32n; } while (seed > 0n);
    const mt = (this.mt = new Uint32Array(624));
    const mul = (a, b) => Math.imul(a, b) >>> 0;
    mt[0] = 19650218;
    for (let i = 1; i < 624; i++) mt[i] = mul(1812433253, mt[i - 1] ^ (mt[i - 1] >>> 30)) + i;
    let i = 1, j = 0;
    const roll = () => { if (++i >= 624) { mt[0] = mt[623]; i = 1; } };
    for (let k = Math.max(624, words.length); k > 0; k--) {
      mt[i] = (mt[i] ^ mul(mt[i - 1] ^ (mt[i - 1] >>> 30), 1664525)) + words[j] + j;
      if (++j >= words.length) j = 0;
      roll();
    }
    for (let k = 623; k > 0; k--) {
      mt[i] = (mt[i] ^ mul(mt[i - 1] ^ (mt[i - 1] >>> 30), 1566083941)) - i;
      roll();
    }
    mt[0] = 0x80000000;
    this.place = 624;
  }
  next() {
    const mt = this.mt;
    if (this.place === 624) {
      for (let i = 0; i < 624; i++) {
        const y = (mt[i] & 0x80000000) | (mt[(i + 1) % 624] & 0x7fffffff);
        mt[i] = mt[(i + 397) % 624] ^ (y >>> 1) ^ (y & 1 ? 0x9908b0df : 0);
      }
      this.place = 0;
    }
    let y = mt[this.place++];
    y ^= y >>> 11;
    y ^= (y << 7) & 0x9d2c5680;
    y ^= (y << 15) & 0xefc60000;
    return (y ^ (y >>> 18)) >>> 0;
  }
  below(n) {
    const drop = Math.clz32(n);
    for (;;) {
      const r = this.next() >>> drop;
      if (r < n) return r;
    }
  }
}
