// Checks certificates: node verify.mjs FILE... Written from docs/certificates.md; it shares no line with verify.py, and
// differs from it where it can: intervals by their ends, exact numbers as sums over sets of roots.
// Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided.
import { readFileSync, statSync } from "node:fs";
import { Impulses } from "./impulses.mjs";
import { Laws } from "./laws.mjs";
import { Mersenne } from "./mersenne.mjs";
import { E, I, MOST, Verdict, begin, bits, doubt, malformed, number, refuse, roots, setBits } from "./numbers.mjs";
import { isInt, key } from "./witnesses.mjs";

class Checker extends Impulses {
  constructor(told) {
    super();
    if (told?.format !== "truebreak/certificate-1") malformed("the format is not truebreak/certificate-1");
    this.told = told;
    const { scene } = told;
    begin();
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
    setBits(BigInt(this.bitsFrom.get(0)));
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

  listAt(c, kind) {
    if (this.get(c)?.kind === "doubt") this.set(c, this.settled(c, null));
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
      this.set(c, this.settled(c, time));
      if (this.get(c) === null || this.get(c).kind === "doubt") return false;
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

  settled(c, time) {
    const sign = I.sign(this.see(c).closing);
    if (sign === -1 && this.zero("graze", c, false)) {
      this.grazed.add(this.heights(c));
      return { kind: "graze", when: this.laws.graze(this.fly, c) };
    }
    const still = this.witnesses.get(`still ${key(c)}`) ?? [];
    if (sign === null && still.some(([how, other]) => this.proves("still", c, how, other))) return null;
    if (time && this.notYet(c, time)) return { kind: "doubt" };
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
    setBits(fewer);
    this.laws = new Laws(I, this.scene);
    this.flights = this.flights.map((f) => ({ x: cut(f.x), y: cut(f.y), vx: cut(f.vx), vy: cut(f.vy), t: cut(f.t), age: f.age }));
    for (const [name, known] of this.coming) if (known?.when) this.coming.set(name, { ...known, when: cut(known.when) });
    this.turnedAt = cut(this.turnedAt);
    this.time = cut(this.time);
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
