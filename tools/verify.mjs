// Checks certificates: node verify.mjs FILE... Written from docs/certificates.md; it shares no line with verify.py, and
// differs from it where it can: intervals by their ends, exact numbers as sums over sets of roots.
// Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided.
import { readFileSync, statSync } from "node:fs";

const MOST = { bytes: 1 << 24, circles: 1000, roots: 16, text: 20000, bits: 1 << 20, size: 2 ** 30, work: 2 ** 38 };

class Verdict extends Error {
  constructor(code, text) {
    super(text);
    this.code = code;
  }
}
const refuse = (text) => { throw new Verdict(1, text); };
const malformed = (text) => { throw new Verdict(2, text); };
const doubt = (text) => { throw new Verdict(4, text); };

// ---- intervals: [low, high] in units of 2**-bits

let bits = 0n;
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

const I = {
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

const roots = [];
let work = 0;
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

class Exact {
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

const E = {
  zero: Exact.of(0n),
  add: (x, y) => x.add(y),
  sub: (x, y) => x.sub(y),
  neg: (x) => x.neg(),
  mul: (x, y) => x.mul(y),
  div: (x, y) => x.div(y),
  sqrt: (x) => x.sqrt(),
  of: (e) => e,
};

function number(text) {
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

// ---- the laws, in either kind of number

class Laws {
  constructor(kind, scene) {
    this.k = kind;
    this.n = scene.n;
    this.scene = scene;
    const all = (rows) => rows.map((row) => row.map(kind.of));
    [this.circles, this.walls, this.pockets] = [all(scene.circles), all(scene.walls), all(scene.pockets)];
    this.lengths = new Map();
  }
  at(f, t) {
    const { add, sub, mul } = this.k;
    if (f.t === t) return [f.x, f.y];
    const s = sub(t, f.t);
    return [add(f.x, mul(f.vx, s)), add(f.y, mul(f.vy, s))];
  }
  wall(i, j) {
    const { mul, add, neg, sqrt } = this.k, [x, y, nx, ny] = this.walls[j - this.n];
    if (!this.lengths.has(j)) this.lengths.set(j, sqrt(add(mul(nx, nx), mul(ny, ny))));
    const side = this.scene.sides.get(`${i},${j}`);
    return { x, y, nx: side ? nx : neg(nx), ny: side ? ny : neg(ny), length: this.lengths.get(j) };
  }
  // time, gap, closing, disc, vv, d and v (a wall: n as v)
  see(fly, [i, j]) {
    const { add, sub, mul, zero } = this.k, a = fly(i);
    if (j >= this.n) {
      const w = this.wall(i, j);
      const height = add(mul(w.nx, sub(a.x, w.x)), mul(w.ny, sub(a.y, w.y)));
      const gap = sub(height, mul(this.circles[i][4], w.length));
      return { t: a.t, gap, closing: add(mul(w.nx, a.vx), mul(w.ny, a.vy)), v: [w.nx, w.ny] };
    }
    const pocket = j < 0 ? this.pockets[-1 - j] : null;
    const b = pocket ? { x: pocket[0], y: pocket[1], vx: zero, vy: zero, t: a.t, age: a.age } : fly(j);
    const reach = pocket ? pocket[2] : add(this.circles[i][4], this.circles[j][4]);
    const t = a.age >= b.age ? a.t : b.t, [ax, ay] = this.at(a, t), [bx, by] = this.at(b, t);
    const d = [sub(bx, ax), sub(by, ay)], v = [sub(b.vx, a.vx), sub(b.vy, a.vy)];
    const cross = sub(mul(d[0], v[1]), mul(d[1], v[0])), square = mul(reach, reach);
    const vv = add(mul(v[0], v[0]), mul(v[1], v[1]));
    const gap = sub(add(mul(d[0], d[0]), mul(d[1], d[1])), square);
    const closing = add(mul(d[0], v[0]), mul(d[1], v[1]));
    return { t, gap, closing, disc: sub(mul(vv, square), mul(cross, cross)), vv, d, v };
  }
  hit(fly, c) {
    const { add, sub, div, neg, sqrt } = this.k, s = this.see(fly, c);
    return add(s.t, div(s.gap, s.disc === undefined ? neg(s.closing) : sub(sqrt(s.disc), s.closing)));
  }
  graze(fly, c) {
    const { sub, div } = this.k, s = this.see(fly, c);
    return sub(s.t, div(s.closing, s.vv));
  }
  arms(fly, [i, j]) {
    const { neg } = this.k, s = this.see(fly, [i, j]);
    if (j >= this.n) return new Map([[i, s.v]]);
    return new Map([[i, [neg(s.d[0]), neg(s.d[1])]], [j, s.d]]);
  }
  effect(fly, c, o) {
    const { add, mul, zero } = this.k;
    if (c[0] === o[0] && c[1] === o[1] && c[1] < this.n) {
      const [p, q] = [this.circles[c[0]], this.circles[c[1]]], reach = add(p[4], q[4]);
      return mul(add(p[5], q[5]), mul(reach, reach));
    }
    const mine = this.arms(fly, c), theirs = this.arms(fly, o);
    let total = zero;
    for (const [i, [x, y]] of mine) {
      if (!theirs.has(i)) continue;
      const [p, q] = theirs.get(i);
      total = add(total, mul(add(mul(x, p), mul(y, q)), this.circles[i][5]));
    }
    return total;
  }
  impulses(fly, push) {
    const { add, sub, mul, div, neg } = this.k;
    const rows = push.map((c) => {
      const u = this.see(fly, c).closing;
      return [...push.map((o) => this.effect(fly, c, o)), neg(add(u, u))];
    });
    const m = push.length;
    for (let k = 0; k < m; k++) {
      for (let r = k + 1; r < m; r++) {
        const factor = div(rows[r][k], rows[k][k]);
        for (let c = k + 1; c <= m; c++) rows[r][c] = sub(rows[r][c], mul(factor, rows[k][c]));
      }
    }
    const s = [];
    for (let k = m - 1; k >= 0; k--) {
      let value = rows[k][m];
      for (let c = k + 1; c < m; c++) value = sub(value, mul(rows[k][c], s[c]));
      s[k] = div(value, rows[k][k]);
    }
    return s;
  }
  slack(fly, c, push, s) {
    const { add, mul } = this.k, u = this.see(fly, c).closing;
    return push.reduce((total, o, k) => add(total, mul(this.effect(fly, c, o), s[k])), add(u, u));
  }
  velocities(fly, push, s) {
    const { add, mul } = this.k, after = new Map();
    push.forEach((c, k) => {
      for (const [i, [x, y]] of this.arms(fly, c)) {
        if (!this.scene.movable.has(i)) continue;
        const [vx, vy] = after.get(i) ?? [fly(i).vx, fly(i).vy], w = mul(this.circles[i][5], s[k]);
        after.set(i, [add(vx, mul(w, x)), add(vy, mul(w, y))]);
      }
    });
    return after;
  }
}

// ---- the checker

const key = (c) => `${c[0]},${c[1]}`;
const inOrder = (a, b) => a[0] - b[0] || a[1] - b[1];
const isInt = Number.isInteger;

class Mersenne {
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

class Checker {
  constructor(told) {
    if (told?.format !== "truebreak/certificate-1") malformed("the format is not truebreak/certificate-1");
    this.told = told;
    const { scene } = told;
    roots.length = work = 0;
    for (const text of told.roots) roots.push(number(text));
    const n = scene.circles.length;
    if (!(n >= 1 && n <= MOST.circles) || roots.length > MOST.roots - 4) malformed("it has no circle, or too much of something");
    const of = (rows, keys) => (rows ?? []).map((row) => keys.map((name) => number(row[name])));
    const circles = of(scene.circles, ["x", "y", "vx", "vy", "r"]);
    circles.forEach((c, i) => c.push(scene.circles[i].m === "oo" ? E.zero : number(scene.circles[i].m).inverse()));
    const walls = of(scene.walls, ["x0", "y0", "x1", "y1"]).map(([a, b, c, d]) => [a, b, b.sub(d), c.sub(a)]);
    const pockets = of(scene.pockets, ["x", "y", "r"]);
    const movable = new Set([...circles.keys()].filter((i) => !circles[i][5].zero));
    this.scene = { n, circles, walls, pockets, movable, sides: new Map() };
    this.n = n;
    this.contacts = [];
    for (let i = 0; i < n; i++) {
      for (let j = i + 1; j < n; j++) {
        const points = circles[i][4].zero && circles[j][4].zero;
        if ((movable.has(i) || movable.has(j)) && !points) this.contacts.push([i, j]);
      }
      if (!movable.has(i)) continue;
      walls.forEach((_, k) => this.contacts.push([i, n + k]));
      pockets.forEach((_, k) => this.contacts.push([i, -1 - k]));
    }
    this.exact = new Laws(E, this.scene);
    this.base = roots.length;
    this.until = told.end.until === undefined ? null : number(told.end.until);
    this.reverseAt = scene.reverse_at === undefined ? null : number(scene.reverse_at);
    const policy = /^(?:simultaneous|sequential(?::order=scene|:seed=(\d{1,18}))?)$/.exec(scene.tie_policy);
    if (!policy) malformed("the tie policy is not known");
    this.together = scene.tie_policy === "simultaneous";
    this.draw = policy[1] === undefined ? null : new Mersenne(BigInt(policy[1]));
    this.bitsFrom = new Map(told.bits);
    if (![...this.bitsFrom.values()].every((b) => isInt(b) && b > 0 && b <= MOST.bits) || !this.bitsFrom.has(0)) malformed("bits");
  }

  checkData() {
    const { circles, pockets } = this.scene, nonzero = (k) => circles.map((c) => c[k]).filter((x) => !x.zero);
    const positive = [...nonzero(4), ...nonzero(5), ...pockets.map((p) => p[2]), this.until, this.reverseAt];
    if (!positive.every((x) => x === null || I.sign(x.interval()) === 1)) malformed("a size, mass or time is not positive");
    if (circles.some((c) => c[5].zero && !(c[2].zero && c[3].zero))) malformed("a fixed circle moves");
    if (this.reverseAt !== null && this.told.scene.reverse_after !== undefined) malformed("there are two reversals");
  }

  check() {
    bits = BigInt(this.bitsFrom.get(0));
    if (this.contacts.length * Number(bits) > MOST.size) malformed("too many bits for so many circles");
    this.checkData();
    this.laws = new Laws(I, this.scene);
    Object.assign(this, { age: 0, count: 0, turnedAt: null, flippedFrom: null, levels: null, time: I.zero });
    Object.assign(this, { rows: this.scene.circles.map(() => []), memo: new Map(), gone: new Set(), lasting: new Map() });
    Object.assign(this, { grazed: new Set(), stood: new Map(), coming: new Map(), isometries: new Map() });
    this.flights = this.laws.circles.map(([x, y, vx, vy]) => ({ x, y, vx, vy, t: I.zero, age: 0 }));
    this.fly = (i) => this.flights[i];
    this.now = (i) => this.flightAfter(i, this.rows[i].length);
    this.where = "at the start";
    this.open(this.told.start);
    this.told.instants.forEach((entry, k) => {
      this.where = `instant ${k}`;
      const fewer = this.bitsFrom.get(k + 1);
      if (fewer) this.shorten(BigInt(fewer));
      this.instant(entry, k === this.told.instants.length - 1);
    });
    this.where = "at the end";
    this.close();
  }

  see(c) { return this.laws.see(this.fly, c); }
  get(c) { return this.coming.get(key(c)) ?? null; }
  set(c, known) { this.coming.set(key(c), known); }
  signOf(question, c, value) {
    const sign = I.sign(value);
    if (sign !== null) return sign;
    this.zero(question, c);
    return 0;
  }

  // time 0
  open(entry) {
    this.begin(entry, { time: E.zero });
    for (const i of this.scene.movable) {
      this.scene.walls.forEach((_, k) => {
        const [x, y, nx, ny] = this.laws.walls[k], f = this.flights[i];
        const side = I.sign(I.add(I.mul(nx, I.sub(f.x, x)), I.mul(ny, I.sub(f.y, y))));
        if (!side) doubt("on which side of a wall a circle starts");
        this.scene.sides.set(`${i},${this.n + k}`, side > 0);
      });
    }
    const known = new Map();
    for (const c of this.contacts) {
      const seen = this.see(c), gap = I.sign(seen.gap);
      if (gap === 0 || (gap === null && this.exactly("rim", c))) {
        known.set(key(c), [c, this.signOf("still", c, seen.closing)]);
      } else if (gap === null) doubt(`whether ${c} overlap`);
      else if (gap < 0 && c[1] >= 0) refuse(`${c} overlap`);
    }
    for (const c of this.contacts) this.set(c, known.has(key(c)) ? null : this.next(c));
    this.resolve(known, entry, [], [], false);
    this.turnIfDue(entry, false, known, this.told.instants.length === 0);
  }

  begin(entry, source) {
    this.source = source;
    this.witnesses = new Map();
    for (const [question, c, how, other] of entry.zeros ?? []) {
      const name = `${question} ${key(c)}`;
      if (!this.witnesses.has(name)) this.witnesses.set(name, []);
      this.witnesses.get(name).push([how, other ?? null]);
    }
  }

  instant(entry, last) {
    this.age += 2;
    const arrive = entry.arrive ?? [], grazes = entry.grazes ?? [];
    if (!Array.isArray(arrive) || !Array.isArray(grazes)) malformed("an instant is none");
    let source;
    if (arrive.length > 0) {
      const clock = this.get(arrive[0]);
      if (clock === null) refuse(`${arrive[0]} do not meet`);
      if (clock.kind === "doubt") doubt(`whether ${arrive[0]} meet`);
      if (clock.kind !== "hit") refuse(`${arrive[0]} only graze`);
      this.time = clock.when;
      source = { contact: arrive[0], places: this.placesOf(arrive[0]) };
    } else {
      if (this.turnedAt !== null || this.reverseAt === null || !entry.reversal) refuse("nothing falls on it");
      this.time = this.reverseAt.interval();
      source = { time: this.reverseAt };
    }
    this.begin(entry, source);
    this.said(this.time, entry.time);
    this.listed = new Set(arrive.slice(0, 1).map(key));
    arrive.slice(1).forEach((c) => this.listAt(c, "hit"));
    grazes.forEach((c) => this.listAt(c, "graze"));
    const near = this.contacts.filter((c) => this.get(c) !== null && !this.listed.has(key(c)) && this.mayGrazeNow(c, this.time));
    const due = this.beforeLimits(arrive[0] ?? null);
    const known = new Map([...this.lasting].map(([k, c]) => [k, [c, 0]]));
    grazes.forEach((c) => known.set(key(c), [c, 0]));
    arrive.forEach((c) => known.set(key(c), [c, -1]));
    this.resolve(known, entry, arrive.length === 1 && arrive[0][1] >= 0 ? [[arrive[0]]] : [], near, false);
    this.turnIfDue(entry, due, known, last);
  }

  placesOf(c) {
    return new Map(c.filter((i) => i >= 0 && i < this.n).map((i) => [i, this.rows[i].length]));
  }

  listAt(c, kind) {
    if (this.get(c)?.kind === "doubt") this.set(c, this.settled(c));
    const known = this.get(c);
    if (known?.kind !== kind || this.listed.has(key(c))) refuse(`${c} do not meet at this instant`);
    const order = I.sign(I.sub(known.when, this.time));
    if (order === 1 || order === -1) refuse(`${c} meet at another time`);
    if (order === null) this.zero("tie", c);
    this.listed.add(key(c));
  }

  beforeLimits(clock) {
    let end = this.until && this.until.interval();
    if (this.told.end.reason === "return" && this.turnedAt !== null) end = I.add(this.turnedAt, this.turnedAt);
    const same = end && !clock && this.until && this.until.sub(this.reverseAt).zero;
    if (end && !same && this.signOf("until", clock, I.sub(end, this.time)) < 0) refuse("it comes after the end");
    if (this.turnedAt !== null || this.reverseAt === null) return false;
    if (clock === null) return true;
    const sign = this.signOf("reverse", clock, I.sub(this.reverseAt.interval(), this.time));
    if (sign < 0) refuse("the reversal comes before it");
    return sign === 0;
  }

  // step 3; true: a graze that may fall on the time
  mayGrazeNow(c, time) {
    if (this.get(c).kind === "doubt") {
      if (time && this.notYet(c, time)) return false;
      this.set(c, this.settled(c));
      if (this.get(c) === null) return false;
    }
    const { kind, when } = this.get(c);
    const order = time ? I.sign(I.sub(when, time)) : -1;
    if (order === 1) return false;
    if (kind === "graze") {
      if (order === -1) this.set(c, null);
      return order !== -1;
    }
    if (order === -1) refuse(`${c} meet before it`);
    return doubt(`whether ${c} meet after it`);
  }

  settled(c) {
    const sign = I.sign(this.see(c).closing);
    if (sign === -1 && this.zero("graze", c, false)) {
      this.grazed.add(this.heights(c));
      return { kind: "graze", when: this.laws.graze(this.fly, c) };
    }
    if (sign === null && this.zero("still", c, false)) return null;
    return doubt(`whether ${c} meet, graze or miss`);
  }

  notYet(c, time) {
    const { t, gap, closing, vv } = this.see(c), s = I.sub(time, t);
    const size = closing[1] > -closing[0] ? closing[1] : -closing[0];
    const fall = I.mul(s, [-2n * size, -2n * size]);
    if (I.sign(I.add(gap, fall)) === 1) return true;
    if (vv === undefined) return false;
    const then = I.add(closing, I.mul(vv, s));
    return I.sign(then) === -1 && I.sign(I.add(gap, I.mul(s, I.add(closing, then)))) === 1;
  }

  next(c) {
    if (this.gone.has(c[0]) || this.gone.has(c[1])) return null;
    const { gap, closing, disc } = this.see(c), sign = I.sign(closing);
    if (sign === 0 || sign === 1) return null;
    if (I.sign(gap) === -1) return c[1] < 0 ? null : refuse(`${c} overlap`);
    const meets = disc === undefined ? 1 : I.sign(disc);
    if (meets === -1) return null;
    if (sign === null || meets === null) return { kind: "doubt" };
    if (meets === 0) return { kind: "graze", when: this.laws.graze(this.fly, c) };
    return { kind: "hit", when: this.laws.hit(this.fly, c) };
  }

  // steps 4 to 6
  resolve(known, entry, usual, near, everyone) {
    const rounds = [...(entry.rounds ?? usual)], moved = new Set(everyone ? this.flights.keys() : []);
    const groups = this.groups([...known.values()].map(([c]) => c).filter((c) => c[1] >= 0), () => true);
    const struck = [];
    for (const group of groups) {
      const coming = group.filter((c) => known.get(key(c))[1] < 0).sort(inOrder);
      if (coming.length > 0) struck.push({ first: coming[0], group: group.sort(inOrder) });
    }
    struck.sort((a, b) => inOrder(a.first, b.first));
    for (const { first, group } of struck) {
      const bodies = new Set(group.flat().filter((i) => i < this.n));
      if (near.some((c) => c[1] >= 0 && (bodies.has(c[0]) || bodies.has(c[1])))) doubt("whether a graze takes part");
      this.rounds(first, group, bodies, known, rounds, moved);
    }
    if (rounds.length > 0) refuse("rounds are left over");
    if (struck.length > 0) this.count++;
    this.stood.set(this.age, new Set([...known.values()].filter(([c]) => c[1] >= 0).map(([c]) => key(c))));
    this.entries(known, entry, moved);
    for (const [name, [c, sign]] of known) {
      this.set(c, null);
      if (c[1] < 0 || (this.lasting.has(name) && !c.some((i) => moved.has(i)))) continue;
      this.lasting.delete(name);
      if (sign !== 0 || c.some((i) => this.gone.has(i))) continue;
      if (c[1] < this.n) {
        const moving = I.sign(this.see(c).vv);
        if (moving === 1) continue;
        if (moving === null) this.zero("together", c);
      }
      this.lasting.set(name, c);
    }
    for (const c of this.contacts) {
      if ((moved.has(c[0]) || moved.has(c[1])) && !known.has(key(c))) this.set(c, this.next(c));
    }
  }

  groups(contacts, joins) {
    const parent = new Map();
    const find = (i) => { while (parent.get(i) !== i) i = parent.get(i); return i; };
    const names = (c) => c.filter((i) => i >= 0 && i < this.n && joins(i));
    for (const c of contacts) {
      for (const i of names(c)) if (!parent.has(i)) parent.set(i, i);
      const [a, ...others] = names(c);
      for (const b of others) parent.set(find(a), find(b));
    }
    const found = new Map();
    for (const c of contacts) {
      const root = find(names(c)[0]);
      if (!found.has(root)) found.set(root, []);
      found.get(root).push(c);
    }
    return [...found.values()];
  }

  rounds(first, group, bodies, known, rounds, moved) {
    const own = this.age > 0 && this.age % 2 === 0;
    const source = own ? { contact: first, places: this.placesOf(first) } : this.source;
    for (const i of bodies) {
      const f = this.flights[i], [x, y] = this.laws.at(f, this.time);
      this.flights[i] = { ...f, x, y, t: this.time, age: this.age };
    }
    for (;;) {
      const coming = group.filter((c) => known.get(key(c))[1] < 0);
      if (coming.length === 0) return;
      if (rounds.length === 0) refuse("a round is missing");
      const push = rounds.shift(), among = this.together ? coming : push;
      const approach = new Set(coming.map(key)), pushing = new Set(push.map(key));
      if (push.length === 0 || pushing.size < push.length || ![...pushing].every((k) => approach.has(k))) refuse(`${push} push`);
      if (!this.together) {
        const place = this.draw && coming.length > 1 ? this.draw.below(coming.length) : 0;
        if (push.length > 1 || key(push[0]) !== key(coming[place])) refuse(`not ${push} but ${coming[place]} is chosen`);
      }
      const s = this.laws.impulses(this.fly, push);
      this.push = push;
      if (this.together) {
        s.forEach((x, k) => {
          const sign = I.sign(x);
          if (sign === null) doubt(`whether ${push[k]} push`);
          if (sign !== 1) refuse(`${push[k]} do not push`);
        });
        for (const c of coming) {
          if (pushing.has(key(c))) continue;
          if (this.signOf("slack", c, this.laws.slack(this.fly, c, push, s)) < 0) refuse(`${c} push too`);
        }
      }
      const after = this.laws.velocities(this.fly, push, s);
      for (const part of this.groups(among, (i) => this.scene.movable.has(i))) {
        const circles = new Set(part.flat().filter((i) => this.scene.movable.has(i)));
        this.log({ kind: "kick", among: part, push: push.filter((c) => part.some((o) => key(o) === key(c))), source }, circles);
      }
      for (const [i, [vx, vy]] of after) {
        this.flights[i] = { ...this.flights[i], vx, vy };
        moved.add(i);
      }
      for (const c of group) {
        if (c.some((i) => after.has(i))) known.get(key(c))[1] = this.signOf("still", c, this.see(c).closing);
      }
    }
  }

  log(block, circles) {
    block.age = this.age;
    block.names = new Set((block.among ?? []).map(key));
    block.places = new Map([...circles].map((i) => [i, this.rows[i].length]));
    if (this.levels && block.kind === "kick") this.undo(block);
    for (const i of circles) this.rows[i].push(block);
  }

  entries(known, entry, moved) {
    const found = [];
    for (const i of this.scene.movable) {
      if (this.gone.has(i)) continue;
      this.scene.pockets.forEach((_, k) => {
        const c = [i, -1 - k], name = key(c);
        let sign = known.get(name)?.[1] ?? 0;
        if (moved.has(i)) {
          const { gap, closing } = this.see(c), rim = I.sign(gap);
          if (!known.has(name) && (rim === 1 || rim === -1)) return;
          sign = this.signOf("still", c, closing);
          if (sign < 0 && !known.has(name) && rim === null) this.zero("rim", c);
          known.set(name, [c, sign]);
        }
        if (sign < 0) found.push(c);
      });
    }
    const listed = (entry.entries ?? []).map(([i, k]) => key([i, -1 - k])).sort();
    if (listed.join(";") !== found.map(key).sort().join(";")) refuse(`[${found.join("; ")}] enter`);
    if (!this.told.scene.capture) return;
    for (const i of new Set(found.map((c) => c[0]))) {
      const [x, y] = this.laws.at(this.flights[i], this.time);
      this.flights[i] = { x, y, vx: I.zero, vy: I.zero, t: this.time, age: this.age };
      this.log({ kind: "take", source: this.source }, [i]);
      this.gone.add(i);
      moved.add(i);
      for (const [name, [c]] of known) {
        if (!c.includes(i)) continue;
        known.delete(name);
        this.set(c, null);
      }
      for (const [name, c] of this.lasting) if (c.includes(i)) this.lasting.delete(name);
    }
  }

  turnIfDue(entry, atSetTime, known, last) {
    const { reverse_after: after } = this.told.scene, { end } = this.told;
    const due = atSetTime || (this.turnedAt === null && after !== undefined && after === this.count);
    if (due && !entry.reversal && last && end.reason === "events" && end.limit === this.count) return;
    if (due !== Boolean(entry.reversal)) refuse(due ? "the reversal falls on it" : "the reversal does not fall on it");
    if (!due) return;
    this.age++;
    this.turnedAt = this.time;
    this.flippedFrom = this.source;
    this.flights = this.flights.map((f) => {
      const [x, y] = this.laws.at(f, this.time);
      return { x, y, vx: I.neg(f.vx), vy: I.neg(f.vy), t: this.time, age: this.age };
    });
    this.levels = this.rows.map((row) => row.length);
    for (const i of this.scene.movable) this.log({ kind: "turn", source: this.source }, [i]);
    const then = new Map([...this.lasting].map(([k, c]) => [k, [c, 0]]));
    for (const [name, [c, sign]] of known) then.set(name, [c, -sign]);
    this.begin(entry.reversal, this.source);
    this.resolve(then, entry.reversal, [], [], true);
    this.age++;
  }

  close() {
    const { end, final } = this.told;
    this.begin(end, this.source);
    const until = { horizon: () => this.until.interval(), return: () => I.add(this.turnedAt, this.turnedAt) }[end.reason];
    if (end.reason === "events") {
      if (end.limit !== this.count) refuse(`there are ${this.count} events`);
    } else if (end.reason === "quiet" || until) {
      if (end.reason === "return" && this.turnedAt === null) refuse("nothing was reversed");
      const time = until ? until() : null;
      if (this.turnedAt === null && this.reverseAt !== null) {
        const sign = time ? I.sign(I.sub(this.reverseAt.interval(), time)) : -1;
        if (sign === null) doubt("whether the reversal comes first");
        if (sign !== 1) refuse("the reversal comes first");
      }
      for (const c of this.contacts) if (this.get(c) !== null) this.mayGrazeNow(c, time);
      if (time) this.time = time;
    } else if (end.reason !== "stopped") malformed("the end is not known");
    this.said(this.time, final.time);
    if (final.circles.length !== this.n) malformed("the final state is not of all circles");
    final.circles.forEach((row, i) => {
      const f = this.flights[i], values = [...this.laws.at(f, this.time), f.vx, f.vy];
      values.forEach((value, k) => this.said(value, row[k]));
    });
  }

  said(value, text) {
    const match = /^(-?)(\d{1,400})(?:\.(\d{1,400}))?$/.exec(text) ?? malformed("a decimal is none");
    const scale = 10n ** BigInt((match[3] ?? "").length);
    const told = BigInt(match[2] + (match[3] ?? "")) * (match[1] ? -1n : 1n);
    const one = 1n << bits;
    if (value[0] * scale > (told - 1n) * one && value[1] * scale < (told + 1n) * one) return;
    if (value[0] * scale >= (told + 1n) * one || value[1] * scale <= (told - 1n) * one) refuse(`a number is not ${text}`);
    doubt(`whether a number is ${text}`);
  }

  shorten(fewer) {
    const drop = bits - fewer, met = new Map();
    if (drop < 0n) malformed("bits grow");
    const cut = (x) => {
      if (!x) return x;
      if (!met.has(x)) met.set(x, [x[0] >> drop, -((-x[1]) >> drop)]);
      return met.get(x);
    };
    bits = fewer;
    this.laws = new Laws(I, this.scene);
    this.flights = this.flights.map((f) => ({ x: cut(f.x), y: cut(f.y), vx: cut(f.vx), vy: cut(f.vy), t: cut(f.t), age: f.age }));
    for (const [name, known] of this.coming) if (known?.when) this.coming.set(name, { ...known, when: cut(known.when) });
    this.turnedAt = cut(this.turnedAt);
    this.time = cut(this.time);
  }

  // ---- witnesses

  zero(question, c, must = true) {
    const found = (c && this.witnesses.get(`${question} ${key(c)}`)) ?? [];
    if (found.some(([how, other]) => this.proves(question, c, how, other))) return true;
    if (found.length > 0) refuse(`the witness of ${question} ${c} proves nothing`);
    if (must) doubt(`${question} of ${c} may be zero, and has no witness`);
    return false;
  }

  proves(question, c, how, other) {
    if (question === "tie" && !this.listed.has(key(other ?? this.source.contact))) return false;
    if (how === "exact") return this.exactly(question, c, other);
    if (how === "back") return this.levels !== null && this.back(question, c, other ?? this.source.contact);
    if (!isInt(how) || how < 0 || how >= this.told.isometries.length) malformed("a witness is none");
    const g = this.isometry(how), [i, j] = c, circle = (k) => k >= 0 && k < this.n;
    if (question === "tie") {
      const to = other ?? this.source.contact;
      const alike = this.get(c).kind === this.get(to).kind && g.contact(c) === key(to);
      return alike && c.filter(circle).every((k) => this.mapsPast(g, k));
    }
    if (question !== "still" && question !== "together") return false;
    const one = Exact.of(1n), [p, q, r, s] = g.matrix;
    if (j >= this.n) {
      const [, , nx, ny] = this.scene.walls[j - this.n];
      const negated = p.mul(nx).add(q.mul(ny)).add(nx).zero && r.mul(nx).add(s.mul(ny)).add(ny).zero;
      return negated && g.map.get(i) === i && this.mapsPast(g, i);
    }
    if (j < 0 || ![p.sub(one), q, r, s.sub(one)].every((x) => x.zero)) return false;
    return (g.map.get(i) === j && this.mapsPast(g, i)) || (g.map.get(j) === i && this.mapsPast(g, j));
  }

  isometry(k) {
    if (this.isometries.has(k)) return this.isometries.get(k);
    const told = this.told.isometries[k], [p, q, r, s] = told.matrix.map(number), [a, b] = told.shift.map(number);
    const one = Exact.of(1n), turn = (x, y) => [p.mul(x).add(q.mul(y)), r.mul(x).add(s.mul(y))];
    const move = (x, y) => { const [u, v] = turn(x, y); return [u.add(a), v.add(b)]; };
    const same = (xs, ys) => xs.every((x, m) => x.sub(ys[m]).zero);
    const { circles, walls, pockets } = this.scene;
    let right = same([p.mul(p).add(r.mul(r)), q.mul(q).add(s.mul(s)), p.mul(q).add(r.mul(s))], [one, one, E.zero]);
    for (const [i, j] of told.map) {
      if (i < 0 && j < 0) {
        const [x, y, size] = pockets[-1 - i];
        right &&= same([...move(x, y), size], pockets[-1 - j]);
      } else if (i >= 0 && j >= 0 && i < this.n && j < this.n) {
        const [x, y, vx, vy, ...kind] = circles[i];
        right &&= same([...move(x, y), ...turn(vx, vy), ...kind], circles[j]);
      } else if (i >= this.n && j >= this.n) {
        const [x, y, nx, ny] = walls[i - this.n], [u, v, mx, my] = walls[j - this.n];
        const on = ([e, f]) => mx.mul(e.sub(u)).add(my.mul(f.sub(v))).zero;
        right &&= on(move(x, y)) && on(move(x.add(ny), y.sub(nx)));
      } else right = false;
    }
    if (!right) refuse(`isometry ${k} does not map what it says`);
    const map = new Map(told.map);
    const contact = ([i, j]) => {
      const e = map.get(i), f = map.get(j);
      if (e === undefined || f === undefined) return null;
      return j >= 0 && j < this.n && e > f ? key([f, e]) : key([e, f]);
    };
    this.isometries.set(k, { matrix: [p, q, r, s], map, contact, proved: new Map() });
    return this.isometries.get(k);
  }

  mapsPast(g, i) {
    const k = g.map.get(i);
    if (k === undefined) return false;
    if (!this.scene.movable.has(i)) return true;
    const [mine, theirs] = [this.rows[i], this.rows[k]];
    if (mine.length !== theirs.length) return false;
    if (mine.length === 0) return true;
    const seen = new Map(), todo = [[mine.at(-1), theirs.at(-1)]];
    while (todo.length > 0) {
      const [a, b] = todo.pop();
      if (g.proved.get(a) === b || seen.get(a) === b) continue;
      if (seen.has(a)) return false;
      seen.set(a, b);
      if (a.kind !== b.kind || a.kind === "take" || a.places.size !== b.places.size || a.names.size !== b.names.size) return false;
      const images = new Set((a.among ?? []).map(g.contact));
      if (images.size !== b.names.size || ![...images].every((name) => b.names.has(name))) return false;
      for (const [m, place] of a.places) {
        const o = g.map.get(m);
        if (o === undefined || b.places.get(o) !== place) return false;
        if (place > 0) todo.push([this.rows[m][place - 1], this.rows[o][place - 1]]);
      }
    }
    for (const [a, b] of seen) g.proved.set(a, b);
    return true;
  }

  undo(block) {
    const lasts = new Set([...block.places.keys()].map((i) => (this.levels[i] ? this.rows[i][this.levels[i] - 1] : null)));
    const [last] = lasts;
    const whole = lasts.size === 1 && last !== null && last.kind === "kick" && last.places.size === block.places.size;
    const pushed = (b) => b.push.map(key).sort().join(";");
    const same = whole && [...block.places.keys()].every((i) => last.places.has(i)) && pushed(last) === pushed(block);
    for (const i of block.places.keys()) this.levels[i] = same ? last.places.get(i) : null;
  }

  heights(c) {
    const circles = c.filter((i) => i >= 0 && i < this.n);
    return `${key(c)}: ${circles.map((i) => (this.levels ? this.levels[i] : this.rows[i].length))}`;
  }

  parted(c) {
    let latest = 0, met = this.stood.get(0);
    for (const i of c) {
      if (!this.scene.movable.has(i)) continue;
      const level = this.levels[i];
      if (level === null) return null;
      if (level === 0) continue;
      const block = this.rows[i][level - 1];
      if (block.age > latest) [latest, met] = [block.age, this.stood.get(block.age)];
      if (block.age === latest) met = new Set([...met, ...block.names]);
    }
    return met.has(key(c)) ? latest : null;
  }

  back(question, c, other) {
    if (question === "graze") return !this.lost(c) && this.grazed.has(this.heights(c));
    if (question === "until") return this.told.end.reason === "return" && this.parted(c) === 0;
    if (question !== "tie") return false;
    const when = this.parted(c);
    return when !== null && when === this.parted(other);
  }

  lost(c) {
    return c.some((i) => i >= 0 && i < this.n && this.levels[i] === null);
  }

  exactly(question, c, other) {
    const base = roots.length, { sub, zero } = E, laws = this.exact;
    try {
      if (question === "tie") {
        const time = (o) => (this.get(o).kind === "graze" ? laws.graze(this.now, o) : laws.hit(this.now, o));
        return sub(time(c), other ? time(other) : this.moment(this.source)).zero;
      }
      if (question === "until" || question === "reverse") {
        const turn = () => { const t = this.moment(this.flippedFrom); return t.add(t); };
        const limit = question === "reverse" ? this.reverseAt : this.told.end.reason === "return" ? turn() : this.until;
        return sub(this.moment(this.source), limit).zero;
      }
      if (question === "slack") {
        const t = this.moment(this.source);
        const fly = (i) => {
          const f = this.now(i), [x, y] = laws.at(f, t);
          return { ...f, x, y, t, age: this.age };
        };
        return laws.slack(fly, c, this.push, laws.impulses(fly, this.push)).zero;
      }
      const seen = laws.see(this.now, c);
      if (question === "together") return seen.v.every((x) => x.zero) && c[1] < this.n;
      const value = { graze: seen.disc, still: seen.closing, rim: seen.gap }[question] ?? malformed("a question is none");
      return sub(value, zero).zero;
    } finally {
      if (roots.length > base) {
        roots.length = base;
        laws.lengths.clear();
        for (const [name, f] of this.memo) {
          if ([f.x, f.y, f.vx, f.vy, f.t].some((x) => x.top() >= base)) this.memo.delete(name);
        }
      }
    }
  }

  moment({ time, contact, places }) {
    return time ?? this.exact.hit((i) => this.flightAfter(i, places.get(i) ?? 0), contact);
  }

  flightAfter(i, p) {
    const todo = [[i, p]];
    while (todo.length > 0) {
      const [k, m] = todo.at(-1);
      if (this.memo.has(`${k} ${m}`)) { todo.pop(); continue; }
      if (m === 0) {
        const [x, y, vx, vy] = this.exact.circles[k];
        this.memo.set(`${k} 0`, { x, y, vx, vy, t: E.zero, age: 0 });
        continue;
      }
      const block = this.rows[k][m - 1];
      const needed = [...block.places, ...(block.source.places ?? [])].filter(([o, q]) => !this.memo.has(`${o} ${q}`));
      if (needed.length > 0) todo.push(...needed);
      else this.carryOut(block);
    }
    return this.memo.get(`${i} ${p}`);
  }

  carryOut(block) {
    const t = this.moment(block.source), at = new Map();
    for (const i of new Set([...block.places.keys(), ...(block.among ?? []).flat().filter((k) => k < this.n)])) {
      const f = this.flightAfter(i, block.places.get(i) ?? 0), [x, y] = this.exact.at(f, t);
      at.set(i, { ...f, x, y, t, age: block.age });
    }
    const fly = (i) => at.get(i);
    const after = block.kind === "kick" ? this.exact.velocities(fly, block.push, this.exact.impulses(fly, block.push)) : new Map();
    for (const [i, place] of block.places) {
      const f = at.get(i);
      let [vx, vy] = after.get(i) ?? [f.vx, f.vy];
      if (block.kind === "turn") [vx, vy] = [vx.neg(), vy.neg()];
      if (block.kind === "take") [vx, vy] = [E.zero, E.zero];
      this.memo.set(`${i} ${place + 1}`, { ...f, vx, vy });
    }
  }
}

function verdict(path) {
  let checker = null;
  try {
    if (statSync(path).size > MOST.bytes) malformed("it is too long");
    checker = new Checker(JSON.parse(readFileSync(path, "utf8")));
    checker.check();
    return [0, `verified: ${checker.count} events, to the end: ${checker.told.end.reason}`];
  } catch (error) {
    const names = { 1: "refuted", 2: "no certificate", 4: "not decided" };
    const code = error instanceof Verdict ? error.code : 2;
    return [code, `${names[code]}: ${checker?.where ?? ""}: ${String(error.message).slice(0, 200)}`];
  }
}

const files = process.argv.slice(2);
const verdicts = files.length > 0 ? files.map(verdict) : [[2, "usage: verify.mjs FILE..."]];
for (const [, sentence] of verdicts) console.log(sentence.replace(/\s+/g, " "));
process.exit(Math.max(...verdicts.map(([code]) => code)));
