// The numbers of the second checker: intervals by their ends, and sums of fractions over sets of roots.

export const MOST = { bytes: 1 << 24, circles: 1000, roots: 16, text: 20000, bits: 1 << 20, size: 2 ** 30, work: 2 ** 38 };

export class Verdict extends Error {
  constructor(code, text) {
    super(text);
    this.code = code;
  }
}
export const refuse = (text) => { throw new Verdict(1, text); };
export const malformed = (text) => { throw new Verdict(2, text); };
export const doubt = (text) => { throw new Verdict(4, text); };

// ---- intervals: [low, high] in units of 2**-bits

export let bits = 0n;
export const setBits = (b) => { bits = b; };
const floorDiv = (a, b) => { const q = a / b; return a % b !== 0n && a < 0n !== b < 0n ? q - 1n : q; };
const ceilDiv = (a, b) => -floorDiv(-a, b);
const up = (a) => -((-a) >> bits);
const least = (xs) => xs.reduce((a, b) => (b < a ? b : a));
const most = (xs) => xs.reduce((a, b) => (b > a ? b : a));

function rootFloor(n) {
  if (n < 2n) return n;
  let x = 1n << BigInt((n.toString(16).length * 4 + 1) >> 1);
  for (;;) {
    const y = (x + n / x) >> 1n;
    if (y >= x) return x;
    x = y;
  }
}

export const I = {
  zero: [0n, 0n],
  add: (x, y) => [x[0] + y[0], x[1] + y[1]],
  sub: (x, y) => [x[0] - y[1], x[1] - y[0]],
  neg: (x) => [-x[1], -x[0]],
  mul(x, y) {
    const p = [x[0] * y[0], x[0] * y[1], x[1] * y[0], x[1] * y[1]];
    return [least(p) >> bits, up(most(p))];
  },
  div(x, y) {
    if (y[0] <= 0n && y[1] >= 0n) doubt("a number that may be zero divides");
    const pairs = [[x[0], y[0]], [x[0], y[1]], [x[1], y[0]], [x[1], y[1]]];
    return [least(pairs.map(([a, b]) => floorDiv(a << bits, b))), most(pairs.map(([a, b]) => ceilDiv(a << bits, b)))];
  },
  sqrt(x) {
    if (x[0] < 0n) doubt("a number that may be negative has a root");
    const low = rootFloor(x[0] << bits), high = rootFloor(x[1] << bits);
    return [low, high * high === x[1] << bits ? high : high + 1n];
  },
  sign: (x) => (x[0] > 0n ? 1 : x[1] < 0n ? -1 : x[0] === 0n && x[1] === 0n ? 0 : null),
  of: (e) => e.interval(),
};

// ---- exact numbers: a fraction for each set of roots (a bit mask)

export const roots = [];
let work = 0;
export const begin = () => { roots.length = work = 0; };
const size = (n) => n.toString(16).length * 4;

// Lehmer: the quotients of Euclid's algorithm as far as the leading 50 bits tell them
function gcd(a, b) {
  if (a < 0n) a = -a;
  if (b < 0n) b = -b;
  if (a < b) [a, b] = [b, a];
  let length = size(a);
  while (b >> 64n) {
    let top = a >> BigInt(length - 50);
    if (top < 1n << 46n) top = a >> BigInt((length = length - 50 + size(top)) - 50);
    const drop = BigInt(length - 50);
    let x = Number(top), y = Number(b >> drop), [p, q, r, s] = [1, 0, 0, 1];
    while (y + r !== 0 && y + s !== 0) {
      const k = Math.floor((x + p) / (y + r));
      if (k !== Math.floor((x + q) / (y + s))) break;
      [p, q, r, s, x, y] = [r, s, p - k * r, q - k * s, y, x - k * y];
    }
    if (q === 0) [a, b] = [b, a % b];
    else {
      const [e, f, g, h] = [p, q, r, s].map(BigInt);
      [a, b] = [e * a + f * b, g * a + h * b];
    }
  }
  while (b) [a, b] = [b, a % b];
  return a;
}

function fraction(p, q) {
  if (q < 0n) [p, q] = [-p, -q];
  const g = gcd(p, q);
  return [p / g, q / g];
}

export class Exact {
  constructor(terms) {
    this.terms = terms;
  }
  static of(p, q = 1n) {
    return new Exact(p === 0n ? new Map() : new Map([[0, fraction(p, q)]]));
  }
  static root(k) {
    return new Exact(new Map([[1 << k, [1n, 1n]]]));
  }
  get zero() {
    return this.terms.size === 0;
  }
  add(o) {
    const sum = new Map(this.terms);
    for (const [mask, [p, q]] of o.terms) {
      const [r, s] = sum.get(mask) ?? [0n, 1n];
      const total = fraction(p * s + r * q, q * s);
      if (total[0] === 0n) sum.delete(mask);
      else sum.set(mask, total);
    }
    return new Exact(sum);
  }
  neg() {
    return new Exact(new Map([...this.terms].map(([mask, [p, q]]) => [mask, [-p, q]])));
  }
  sub(o) {
    return this.add(o.neg());
  }
  mul(o) {
    if (this.zero || o.zero) return E.zero;
    const k = Math.max(this.top(), o.top());
    if (k < 0) {
      const [[p, q], [r, s]] = [this.terms.get(0), o.terms.get(0)];
      work += 10000 + ((size(p) + size(q)) * (size(r) + size(s))) / 256;
      if (work > MOST.work) doubt("an exact witness takes too much work");
      return Exact.of(p * r, q * s);
    }
    const [a, b] = this.split(k), [c, d] = o.split(k);
    const low = b.zero || d.zero ? a.mul(c) : a.mul(c).add(b.mul(d).mul(roots[k]));
    return low.add(a.mul(d).add(b.mul(c)).raised(k));
  }
  raised(k) {
    return new Exact(new Map([...this.terms].map(([mask, c]) => [mask | (1 << k), c])));
  }
  top() {
    let mask = 0;
    for (const m of this.terms.keys()) mask |= m;
    return mask ? 31 - Math.clz32(mask) : -1;
  }
  split(k) {
    const a = new Map(), b = new Map();
    for (const [m, c] of this.terms) ((m >> k) & 1 ? b : a).set(m & ~(1 << k), c);
    return [new Exact(a), new Exact(b)];
  }
  inverse() {
    const k = this.top();
    if (k < 0) {
      if (this.zero) malformed("a zero divides");
      const [p, q] = this.terms.get(0);
      return Exact.of(q, p);
    }
    const [a, b] = this.split(k);
    return a.sub(b.raised(k)).mul(a.mul(a).sub(b.mul(b).mul(roots[k])).inverse());
  }
  div(o) {
    return this.mul(o.inverse());
  }
  interval() {
    let total = I.zero;
    for (const [mask, [p, q]] of this.terms) {
      let part = [floorDiv(p << bits, q), ceilDiv(p << bits, q)];
      for (let k = 0; mask >> k; k++) if ((mask >> k) & 1) part = I.mul(part, I.sqrt(roots[k].interval()));
      total = I.add(total, part);
    }
    return total;
  }
  within(count) {
    if (this.zero) return this;
    if (count === 0) {
      const [p, q] = this.terms.get(0);
      if (p < 0n) return null;
      const r = rootFloor(p), s = rootFloor(q);
      return r * r === p && s * s === q ? Exact.of(r, s) : null;
    }
    const k = count - 1, [a, b] = this.split(k);
    if (b.zero) return a.within(k) ?? a.div(roots[k]).within(k)?.raised(k) ?? null;
    const norm = a.mul(a).sub(b.mul(b).mul(roots[k])).within(k);
    if (norm === null) return null;
    for (const n of [norm, norm.neg()]) {
      const c = a.add(n).div(Exact.of(2n)).within(k);
      if (c !== null && !c.zero) return c.add(b.div(c.add(c)).raised(k));
    }
    return null;
  }
  sqrt() {
    if (I.sign(this.interval()) !== 1) doubt("a number that may not be positive has a root");
    const found = this.within(roots.length);
    if (found === null) {
      if (roots.length >= MOST.roots) doubt("an exact witness takes too many roots");
      roots.push(this);
      return Exact.root(roots.length - 1);
    }
    const sign = I.sign(found.interval());
    if (sign === null) doubt("a root may have either sign");
    return sign > 0 ? found : found.neg();
  }
}

export const E = {
  zero: Exact.of(0n),
  add: (x, y) => x.add(y),
  sub: (x, y) => x.sub(y),
  neg: (x) => x.neg(),
  mul: (x, y) => x.mul(y),
  div: (x, y) => x.div(y),
  sqrt: (x) => x.sqrt(),
  of: (e) => e,
};

export function number(text) {
  if (typeof text !== "string" || text.length > MOST.text) malformed("a number is no text, or too long");
  if (!/^[+-]?\d+(\/\d+)?(\*r\d+)*([+-]\d+(\/\d+)?(\*r\d+)*)*$/.test(text)) malformed(`${text.slice(0, 40)} is no number`);
  let total = E.zero;
  for (const term of text.match(/[+-]?[^+-]+/g)) {
    const [factor, ...names] = term.split("*r");
    const [p, q] = factor.replace("+", "").split("/");
    if (q !== undefined && BigInt(q) === 0n) malformed("a zero divides");
    let part = Exact.of(BigInt(p), BigInt(q ?? 1));
    for (const name of names) {
      const k = Number(name) - 1;
      if (!(k >= 0 && k < roots.length)) malformed(`there is no root r${name}`);
      part = part.mul(Exact.root(k));
    }
    total = total.add(part);
  }
  return total;
}
