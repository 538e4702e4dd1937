// The checker of a run: flights, instants, the end. The numbers of the steps are those of the format's page.
import { malformed, refute, undecided, Verdict, TooMuch } from './base.mjs';
import { Scene } from './scene.mjs';
import { Isometry } from './isometry.mjs';
import { WayBack } from './back.mjs';
import { Random } from './random.mjs';
import { append, Rounds } from './rounds.mjs';
import { ZERO } from './exact.mjs';
import { witness } from './witness.mjs';
import { theEnd } from './end.mjs';
import { bounce, flatten, holds, rest, stilled } from './calm.mjs';
import { divided, falling, horner, keeps, slope } from './quartic.mjs';

/** @typedef {import('./scene.mjs').Contact} Contact */
/** @typedef {{c: Contact, sign: number, lasted: boolean, from?: number}} Known a contact at gap zero, the sign of its closing speed, and when it was known before */

export class Run {
  constructor(certificate, bits, work) {
    this.certificate = certificate;
    this.work = work;
    this.place = 'the scene';
    this.bits = bits;
  }

  /** @returns {string} what is verified; or throws a Verdict */
  check() {
    const { certificate: c } = this;
    try {
      const scene = this.scene = new Scene(c, this.bits, this.work);
      this.place = 'the isometries';
      this.isometries = c.isometries.map((g, k) => new Isometry(g, scene, this.work, `isometry ${k}`));
      this.fixed = scene.circles.map(x => x.fixed);
      this.random = c.scene.tie_policy.seed === null ? null : new Random(c.scene.tie_policy.seed);
      this.back = new WayBack();
      this.zero = scene.number({ den: 1n, terms: new Map() });
      this.now = this.zero;
      /** flights: p and v are pairs of numbers, t a number, start the instant at which it began */
      this.flights = scene.circles.map(x => ({ p: [x.x, x.y], v: [x.vx, x.vy], t: this.zero, start: 0 }));
      this.turnedAt = scene.circles.map(() => 0); // the instant at which the velocity changed last
      this.captured = scene.circles.map(() => false);
      /** @type {Map<number, number>} the instant at which a contact was known last */ this.knownAt = new Map();
      /** @type {Map<number, {k: number, t: object, order: number}>} of one that stands: when its gap was zero last, and of what order */
      this.zeroes = new Map();
      /** @type {Map<number, Known>} known at the last instant, as left */ this.left = new Map();
      /** @type {Map<number, object>} what bounces infinitely often, by circles */ this.bounces = new Map();
      this.events = 0;
      this.turnTime = null;
      this.due = false;
      c.instants.forEach((e, k) => { this.place = `instant ${k}`; this.instant(e, k); });
      this.place = 'the end';
      theEnd(this);
    } catch (e) {
      if (e instanceof Verdict && !(e instanceof TooMuch)) e.message = `${this.place}: ${e.message}`;
      throw e;
    }
    const kinds = ['circles', 'walls', 'pockets', ...c.named];
    const things = kinds.map(kind => `${c.scene[kind].length} ${kind}`).join(', ');
    return `${this.events} event${this.events === 1 ? '' : 's'}, to the end: ${c.end.reason}; ${things}; scene sha256:${c.digest}`;
  }

  // Numbers of the flights

  /** Where circle i is now. It is computed once for each instant and world. */
  here(i, w) {
    const f = this.flights[i], A = this.scene.worlds[w];
    if (f.start === this.k) return f.p.map(x => x[w]);
    const cache = this.cache[i] ??= [];
    return cache[w] ??= this.moved(f, A, w, A.sub(this.now[w], f.t[w]));
  }
  moved(f, A, w, time) { return f.p.map((x, k) => A.add(x[w], A.mul(f.v[k][w], time))); }

  /** The laws for a contact, now or at the later start of its flights. */
  laws(c, A, w, atStart = false) {
    const { flights } = this, f = flights[c.i], g = c.kind === 'circle' ? flights[c.j] : null;
    const velocity = h => h && h.v.map(x => x[w]);
    const place = (h, other, i) => {
      if (!h) return null;
      if (!atStart) return this.here(i, w);
      return other && other.start > h.start ? this.moved(h, A, w, A.sub(other.t[w], h.t[w])) : h.p.map(x => x[w]);
    };
    const time = () => (atStart ? this.startOf(c) : this.now)[w]; // of walls, and of what stands where others fall
    return this.scene.laws(c, A, w, place(f, g, c.i), velocity(f), place(g, f, c.j), velocity(g), c.kind === 'wall' || c.drops ? time() : null);
  }
  /** The later start of the flights of a contact. */
  startOf(c) {
    const f = this.flights[c.i], g = c.kind === 'circle' ? this.flights[c.j] : f;
    return (g.start > f.start ? g : f).t;
  }
  /** Since when a gap with one that stands is a polynomial, and of what order its zero is there. */
  since(c) {
    const { mover, peg } = c.drops, last = this.scene.carried.has(peg) && this.flights[peg].start > this.flights[mover].start ? peg : mover;
    const { start, t } = this.flights[last];
    return this.parted(c) ? this.zeroes.get(c.key) : { k: start, t, order: 0 };
  }
  /** The laws of such a contact at a time since which its gap is that polynomial. */
  fallingLaws(c, A, w, t) {
    const { mover, peg } = c.drops, f = this.flights[mover], there = this.moved(f, A, w, A.sub(t[w], f.t[w])), way = f.v.map(x => x[w]);
    const end = peg < 0 ? null : this.flights[peg], own = end && end.v.map(x => x[w]), moves = end && (this.scene.circles[peg].way || this.scene.carried.has(peg));
    const at = end && (moves ? this.moved(end, A, w, A.sub(t[w], end.t[w])) : end.p.map(x => x[w])), pace = moves ? own : null;
    const both = mover === c.i ? [there, way, at, pace] : [at, pace, there, way];
    return this.scene.laws(c, A, w, ...both, t[w]);
  }
  sign(law) { return this.scene.sign(law); }
  /** The sign of a number that no witness can show to be zero. */
  known(law, what) { return this.sign(law) ?? undecided(what); }

  movers(c) { return (c.kind === 'circle' ? [c.i, c.j] : [c.i]).filter(i => !this.fixed[i]); }
  /** Has it been known at an instant since which neither circle turned? Then it was at gap zero, parted or lasts. */
  parted(c) {
    const k = this.knownAt.get(c.key);
    return k !== undefined && this.movers(c).every(i => this.turnedAt[i] <= k);
  }
  /** Of a wall to which a circle is pulled, or the inside of an arc: was it at gap zero where the flight starts? */
  fromZero(c) { return this.parted(c) && this.flights[c.i].start === this.knownAt.get(c.key); }
  * contactsOf(i) {
    if (this.captured[i]) return;
    for (const c of this.scene.contactsOf(i)) {
      if (c.kind !== 'circle' || !this.captured[c.i === i ? c.j : c.i]) yield c;
    }
  }

  // Witnesses

  /** The sign of a number, where witnesses may show that it is zero. */
  signed(law, question, c, what, first = false) {
    const s = this.sign(law);
    if (s === undefined) witness(this, question, c, what, first);
    return s ?? 0;
  }

  /**
   * Proves that the two of a contact did not meet from the later start of their flights until now (or for ever).
   * @param {'flight' | 'end' | 'ever'} mode
   */
  apart(c, mode) {
    if (this.scene.falls(c)) { this.rises(c, mode); return; }
    if (c.drops) { this.stays(c, mode); return; }
    if (c.kind === 'arc' || this.scene.slope(c) !== null) { this.misses(c, mode); return; }
    if (this.parted(c)) return;
    if (c.face) { this.passes(c, mode); return; }
    const start = name => (A, w) => this.laws(c, A, w, true)[name]();
    const now = name => (A, w) => this.laws(c, A, w)[name]();
    const what = `whether ${c.name} kept apart`;
    const gap = this.known(start('gap'), what);
    if (gap < 0 && c.kind === 'pocket') return; // the centre is inside, and does not enter again
    if (gap <= 0) refute(`${c.name} is at gap zero or overlaps where its flight starts`);
    const closing = this.sign(start('closing'));
    if (closing >= 0) return;
    const disc = this.sign(start('disc'));
    if (disc < 0 || (disc === 0 && mode !== 'flight' && !c.blunt)) return;
    let gapNow, closingNow;
    if (mode !== 'ever') {
      const rise = (A, w, laws) => A.twice(A.mul(laws.closing(), A.sub(this.now[w], this.startOf(c)[w])));
      const atStart = (A, w, laws = this.laws(c, A, w, true)) => A.add(laws.gap(), rise(A, w, laws));
      const atEnd = (A, w, laws = this.laws(c, A, w)) => A.sub(laws.gap(), rise(A, w, laws));
      if (this.sign((A, w) => atStart(A, w)) > 0) return;
      gapNow = this.sign(now('gap'));
      closingNow = this.sign(now('closing'));
      if (gapNow > 0) {
        if ((disc === 0 && !c.blunt) || closingNow < 0) return; // closingNow < 0: the tangent at the end rises backwards
        if (this.sign((A, w) => atEnd(A, w)) > 0) return;
      }
    }
    // What is left: they met; or it is not known; or a witness says more.
    if (closing < 0 && ((disc > 0 && (mode === 'ever' || gapNow <= 0 || closingNow >= 0)) || (disc === 0 && gapNow <= 0))) {
      refute(`${c.name} meet, which is not told`);
    }
    const asked = [[closing, 'closing'], [c.blunt ? 0 : disc, 'disc']].filter(([s]) => s === undefined).map(([, question]) => question);
    for (const question of mode !== 'flight' || gapNow > 0 ? asked : []) {
      try { return witness(this, question, c, what); } catch (e) {
        if (!(e instanceof Verdict) || e.code !== 4 || e instanceof TooMuch) throw e;
      }
    }
    undecided(what);
  }

  /** As `apart`, of a wall to which the circle is pulled: its gap was not negative, and is concave. */
  rises(c, mode) {
    if (mode === 'ever') refute(`${c.name} meet in the end`);
    if (this.flights[c.i].start === this.k) return;
    const again = this.fromZero(c), wait = (A, w) => A.sub(this.now[w], this.startOf(c)[w]);
    const over = (A, w, laws) => A.add(A.twice(laws.closing()), A.mul(laws.speed(), wait(A, w))); // the gap over the time
    const gap = (A, w) => (again ? over(A, w, this.laws(c, A, w, true)) : this.laws(c, A, w).gap());
    if (this.known(gap, `whether ${c.name} kept apart`) <= 0) refute(`${c.name} meet, which is not told`);
  }

  /**
   * As `apart`, of one that stands where the other falls: the gap is positive, but for a zero of such an order now. Of a rim, or a side of an arc, it falls to no
   * other zero, within the range of that.
   */
  stays(c, mode, order = 0) {
    const since = { ...this.since(c) }, { worlds, sameLow, circles } = this.scene, ring = c.kind !== 'circle', leaves = c.kind !== 'pocket' && this.parted(c);
    if (since.k === this.k && this.k && mode !== 'ever') return;
    const graze = order === 2, other = c.kind === 'arc' && circles[c.i].point ? this.scene.otherSide(c) : null;
    if (other) { // of a point both sides are at gap zero at once
      const there = this.met.find(x => x.c.key === other.key);
      if (this.parted(other) && this.zeroes.get(other.key).k === since.k) since.order = this.zeroes.get(other.key).order;
      if (there) order = there.sign ? 1 : 2;
    }
    for (const w of sameLow ? [1] : [0, 1]) {
      const A = worlds[w], wait = mode === 'ever' ? null : A.sub(this.now[w], since.t[w]);
      const laws = this.fallingLaws(c, A, w, since.t), all = laws.quartic();
      let row = all.slice(since.order);
      for (let k = 0; k < order; k++) row = divided(row, wait, A);
      const rows = ring ? [row, row.map(x => A.neg(x)), slope(all)] : [row];
      if (c.kind === 'arc') rows.push(laws.beyond());
      const reads = [keeps(rows, wait, A)];
      if (leaves) reads.push(A.sign(all[since.order]));
      if (graze) reads.push(A.sign(horner(row, wait, A)));
      if (reads.every(s => s > 0)) return;
      if (reads.some(s => s <= 0)) refute(`${c.name} meet, which is not told, or overlap`);
    }
    undecided(`whether ${c.name} kept apart`);
  }

  /** At time 0: no circle lies in a segment, as one of its faces tells. */
  outside(c) {
    const at = name => this.sign((A, w) => this.laws(c, A, w)[name]());
    const [gap, height, foot, far] = ['gap', 'height', 'foot', 'far'].map(at);
    if (gap > 0 || height < 0 || foot <= 0 || far <= 0) return;
    if (gap <= 0 && foot > 0 && far > 0 && height >= 0) refute(`${c.name} starts in a segment`);
    undecided(`whether ${c.name} starts in a segment`);
  }

  /** As `apart`, of a side of an arc, or of a face under gravity: its gap does not fall through zero within its range. */
  misses(c, mode) {
    const slope = this.scene.slope(c), hollow = c.hollow || slope < 0, ever = mode === 'ever';
    const other = c.face ? this.scene.otherFace(c) : this.scene.otherSide(c);
    if (this.flights[c.i].start === this.k && !ever) return;
    if ((other && this.parted(other)) || (!hollow && slope !== 0 && this.parted(c))) return;
    if (this.left.get(c.key)?.lasted && this.parted(c)) return; // it rests there
    if (c.hollow && this.met.some(x => x.c.key === other.key)) return; // it was outside up to now
    const what = `whether ${c.name} meet on the way`, again = hollow && this.fromZero(c);
    const at = (name, start = true) => this.sign((A, w) => this.laws(c, A, w, start)[name]());
    const gap = again ? 0 : at('gap'), closing = at('closing'), disc = at('disc');
    const gapNow = ever ? undefined : at('gap', false), closingNow = ever ? undefined : at('closing', false);
    if (disc < 0 && !again) return;
    if (hollow) { // the gap is concave: it falls after now, or fell before the start
      if (gapNow > 0 || closingNow > 0 || (gap < 0 && closing <= 0)) return;
    } else if (gap < 0 || closing > 0 || (gapNow > 0 && (closingNow < 0 || (slope === 0 && gap > 0)))) return; // convex, or straight
    else if (closing === 0 && (gap > 0 || slope !== 0)) return;
    const zero = again ? closing > 0 : disc > 0; // it falls once; where is that?
    const reads = zero ? [0, 1].slice(c.face ? 0 : 1).map(k => this.sign((A, w) => this.falling(c, A, w, again, k))) : [undefined];
    if (reads.some(s => s < 0 || (s === 0 && c.face))) return;
    const there = reads.every(s => s > 0) ? 1 : undefined;
    if (slope === 0 && !(gap > 0) && (closing === undefined || closing === 0)) { // it slides along the line, if it is at it
      if (closing === undefined) witness(this, 'closing', c, what);
      this.slides(c, mode, gap);
      return;
    }
    const ends = c.face ? ['foot', 'far'] : ['within'];
    const turns = () => !hollow && slope !== 0 && !closingNow && this.nowZero(c, 'closing'); // there it is least
    if (!ever && (closingNow < 0 || turns()) && ends.some(x => this.exactly(c, x)) && this.nowZero(c)) return; // it is at its end
    const grazes = hollow ? (again || !this.aside(c, at, closing) ? [] : ['disc']) : mode === 'flight' && !(gapNow > 0) ? [] : ['closing', 'disc'].slice(0, gap > 0 ? 2 : +(slope !== 0));
    for (const question of grazes) {
      if (at(question) === 0) return;
      try { return witness(this, question, c, what); } catch (e) {
        if (!(e instanceof Verdict) || e.code !== 4 || e instanceof TooMuch) throw e;
      }
    }
    const ahead = hollow ? gap > 0 || closing > 0 : gap > 0 && closing < 0;
    const done = hollow ? closingNow < 0 && gapNow <= 0 : gapNow <= 0 || closingNow > 0;
    if (ahead && there > 0 && (ever || done)) refute(`${c.name} meet, which is not told`);
    undecided(what);
  }
  /** Is the gap of a side of an arc within its range where it falls through zero, seen from the start of the flight? */
  falling(c, A, w, again, end) {
    if (w === 2) return null; // there is a root, or a division
    const l = this.laws(c, A, w, true), closing = l.closing(), disc = again ? null : l.disc();
    if (disc && disc.lo <= 0n) return null;
    const concave = c.kind === 'arc' || this.scene.slope(c) < 0;
    const wait = concave ? A.div(A.neg(A.add(closing, again ? closing : A.sqrt(disc))), l.speed()) : A.div(l.gap(), A.sub(A.sqrt(disc), closing));
    return wait && (c.face ? l.beside(wait)[end] : l.after(wait));
  }
  /**
   * A concave gap whose two zeros are one is never positive; but what it is of may begin just there, and be gone into without a fall. Is that one zero surely
   * within its range, or out of it? Or at the end of an arc, at the start, on the way out?
   */
  aside(c, at, closing) {
    if (at('speed') === 0) return true; // it rests
    const signs = [0, 1].slice(c.face ? 0 : 1).map(k => this.sign((A, w) => {
      if (w === 2) return null; // there is a division
      const l = this.laws(c, A, w, true), wait = A.div(A.neg(l.closing()), l.speed());
      return wait && (c.face ? l.beside(wait)[k] : l.after(wait));
    }));
    if (signs.some(s => s < 0) || signs.every(s => s > 0)) return true;
    return c.kind === 'arc' && at('onward') < 0 && (closing ?? at('closing')) === 0;
  }
  /** Is a number of a contact zero now, as exact numbers tell? */
  exactly(c, name) {
    const [, full, exact] = this.scene.worlds;
    return !full.sign(this.laws(c, full, 1)[name]()) && exact.sign(this.laws(c, exact, 2)[name]()) === 0;
  }
  /** Is a number of a contact, its gap, shown to be zero now? */
  nowZero(c, name = 'gap') {
    const s = this.sign((A, w) => this.laws(c, A, w)[name]());
    if (s !== undefined) return s === 0;
    try { witness(this, name, c, ''); return true; } catch (e) {
      if (!(e instanceof Verdict) || e.code !== 4 || e instanceof TooMuch) throw e;
      return false;
    }
  }
  /** At time 0: no circle lies across an arc. */
  across(c, known) {
    const sides = [c, this.scene.otherSide(c)].filter(x => x);
    const there = sides.filter(x => known.has(x.key));
    if (there.length && this.scene.circles[c.i].point) refute(`the centre of ${c.name} is on the arc`);
    if (there.length) return;
    const gaps = sides.map(x => this.sign((A, w) => this.laws(x, A, w).gap()));
    if (gaps.some(s => s > 0)) return;
    const within = this.sign((A, w) => {
      const l = this.laws(c, A, w), square = w === 2 ? null : l.square();
      return square && square.lo > 0n ? l.widely(A.sqrt(square)) : null;
    });
    if (within < 0 || sides.some(x => this.exactly(x, 'within') && this.nowZero(x))) return;
    if (within > 0 && gaps.every(s => s <= 0)) refute(`${c.name} lie across each other at time 0`);
    undecided(`whether ${c.name} lie across each other`);
  }

  /** As `apart`, of a face: it is not met; and, where a flight ends, it is not touched. */
  passes(c, mode) {
    if (this.parted(this.scene.otherFace(c))) return; // on the other side all the while
    const at = (name, start = true) => this.sign((A, w) => this.laws(c, A, w, start)[name]());
    const aside = () => at('foot') <= 0 || at('far') <= 0;
    const what = `whether ${c.name} kept apart`, gap = at('gap');
    if (this.flights[c.i].start === 0 && !(gap > 0 || at('height') < 0 || aside())) {
      if (gap <= 0 && at('foot') > 0 && at('far') > 0 && at('height') >= 0) refute(`${c.name} overlap, or touch from the start`);
      undecided(`whether ${c.name} overlap`);
    }
    if (gap < 0) return; // behind it, or beside
    const closing = at('closing');
    if (closing > 0 || (closing === 0 && gap > 0)) return;
    if (mode !== 'ever' && gap > 0 && at('gap', false) > 0) return;
    if (closing < 0) {
      const near = at('near'), beyond = at('beyond');
      if (near <= 0 || beyond <= 0) return;
      if (gap > 0 && near > 0 && beyond > 0 && (mode === 'ever' || at('gap', false) <= 0)) refute(`${c.name} meet on the way`);
      undecided(`whether ${c.name} meet on the way`);
    }
    if (closing === undefined) witness(this, 'closing', c, what);
    this.slides(c, mode, gap);
  }
  /** Along a face, if it is at its line: it is not beside it where a flight ends. */
  slides(c, mode, gap) {
    const [foot, far] = ['foot', 'far'].map(name => this.sign((A, w) => this.laws(c, A, w)[name]()));
    if (gap > 0 || mode !== 'flight' || foot <= 0 || far <= 0) return;
    if (gap === 0 && foot > 0 && far > 0) refute(`${c.name} touch as the flight ends`);
    undecided(`whether ${c.name} touch as the flight ends`);
  }
  /** Is the foot of the centre now strictly between the ends of a face, or the centre within the range of an arc? */
  within(c) {
    const what = `whether ${c.name} is beside it`;
    return (c.kind === 'arc' ? ['within'] : ['foot', 'far']).every(name => this.known((A, w) => this.laws(c, A, w)[name](), what) > 0);
  }

  /** Ends the flights of these circles now: all that is not known did not meet. Then they fly on from here. */
  endFlights(circles, known) {
    const ending = new Set(circles);
    for (const i of ending) for (const c of this.contactsOf(i)) {
      if (known.has(c.key) || (c.drops?.peg === i && this.fixed[i])) continue; // of what is fixed, flights of others end
      const other = c.kind === 'circle' && !c.drops ? (c.i === i ? c.j : c.i) : -1;
      if (other < i && ending.has(other)) continue; // done
      if (other >= 0 && !ending.has(other) && this.flights[other].start === this.k && this.k) continue; // done when that ended
      this.apart(c, 'flight');
    }
    for (const i of ending) this.fresh(i);
  }
  fresh(i) {
    const f = this.flights[i], p = [1, 2].map(w => this.here(i, w));
    this.flights[i] = { ...f, p: [0, 1].map(k => this.scene.widen(p[0][k], p[1][k])), t: this.now, start: this.k };
  }

  // An instant

  instant(e, k) {
    const { scene } = this, { end } = this.certificate;
    Object.assign(this, { k, cache: [], met: [], rows: null, witnesses: e.zeros ?? [], calm: [] });
    const turn = Boolean(e.turn), before = this.now;
    if (k && this.due !== turn) refute(turn ? 'no reversal is due' : 'a reversal is due');
    if (k === 0 && turn) refute('the first instant is a reversal');
    if (turn && e.met) refute('a reversal with contacts that meet');
    if (end.reason === 'events' && this.events >= end.limit) refute('an instant after the last event');

    // 1, 2: the time
    const met = (e.met ?? []).map(([i, j]) => this.meeting(scene.contact(i, j), i, j));
    if (new Set(met.map(c => c.key)).size !== met.length) refute('a contact meets twice');
    const ended = [...new Set((e.settle ?? []).map(([i]) => i).filter(i => this.bounces.has(i)))].sort((a, b) => a - b);
    let told = false; // by the clock
    if (e.exact) this.now = scene.number(scene.exact.reduced(e.exact));
    if (k === 0 || turn) {
      if (e.exact) refute('it has a time already');
      this.now = before;
    } else if (!e.exact && !met.length) {
      this.now = ended.length ? stilled(this, ended[0]) : malformed('an instant without a time');
    } else if (!e.exact) {
      this.now = met[0].drops ? this.drop(met[0], e.time) : this.clock(met[0]);
      told = true;
    }
    if (k && !turn) {
      const s = this.known((A, w) => A.sub(this.now[w], before[w]), 'whether it comes after the instant before');
      if (s <= 0) refute('it does not come after the instant before');
    }
    this.decimal(this.now, e.time, 'the time');

    // 3: what meets
    for (const c of met) this.meet(c, told && c === met[0]);
    for (const i of ended) { // its bounces have come to their end
      const { contacts } = this.bounces.get(i);
      if (i !== ended[0] || met.length || e.exact) this.bouncesNoMore(i);
      this.calm.push(...contacts);
    }
    for (const i of ended) this.bounces.delete(i);

    // 4: what is known; the time and the ends
    /** @type {Map<number, Known>} */ const known = new Map(this.met.map(x => [x.c.key, x]));
    for (const x of this.left.values()) if (turn || (x.lasted && (!x.c.face || this.within(x.c)))) known.set(x.c.key, { ...x, sign: turn ? -x.sign : x.sign });
    if (k === 0) for (const i of this.moving()) for (const c of this.contactsOf(i)) {
      if (c.kind === 'arc' && !c.hollow) this.across(c, known);
      if (scene.slope(c) !== null && !known.has(c.key)) this.outside(c);
      if (!scene.falls(c) || known.has(c.key)) continue;
      if (this.known((A, w) => this.laws(c, A, w).gap(), `whether ${c.name} overlap`) <= 0) refute(`${c.name} overlap at time 0`);
    }
    if (turn) {
      this.endFlights(this.flights.keys(), known);
      this.turnTime = this.now;
      for (const i of this.moving()) {
        this.flights[i].v = this.flights[i].v.map((x, a) => this.turned(x, a));
        this.turnedAt[i] = k;
      }
    }
    this.due = this.ahead(e, ended);

    // 5: groups and rounds
    const rounds = new Rounds(this, known, e.rounds ?? []);
    rounds.all();
    if (e.rounds?.length) this.events++;
    if (!this.turnTime && this.events === this.certificate.scene.reverse_after) this.due = true;

    // 6: entries
    const pairs = e.enter ?? [], entering = [...known.values()].filter(x => x.c.kind === 'pocket' && x.sign < 0);
    const entered = new Set(pairs.map(([i, j]) => this.meeting(scene.contact(i, j), i, j).key));
    if (entered.size !== pairs.length || entered.size !== entering.length || entering.some(x => !entered.has(x.c.key))) {
      refute('not these circles enter pockets');
    }
    const caught = this.certificate.scene.capture ? new Set(entering.map(x => x.c.i)) : new Set();
    this.capture(caught, known, rounds.pushed);

    this.settle(e, known, rounds);

    // 7: what lasts
    for (const x of known.values()) {
      this.knownAt.set(x.c.key, k);
      if (x.c.drops) this.zeroes.set(x.c.key, { k, t: this.now, order: x.sign === 0 ? 2 : 1 });
      if (this.movers(x.c).some(i => this.captured[i])) { known.delete(x.c.key); continue; }
      if (x.lasted && !this.movers(x.c).some(i => rounds.pushed.has(i))) continue;
      x.lasted = x.sign === 0 && !x.c.drops && this.signed((A, w) => this.laws(x.c, A, w).speed(), 'speed', x.c,
        `whether the two of ${x.c.name} move as one`) === 0;
    }
    this.left = known;

    // the pasts
    if (rounds.rows.size) for (const g of this.isometries) g.struck = g.struckBy(rounds.rows);
    if (e.rounds?.length || k === 0) { // time 0 is never on the way back
      const pushes = WayBack.pushes(rounds.pushes, this.fixed);
      this.work.keep(this.turnTime ? 0 : 200 * (rounds.pushes.length + rounds.keys.size + pushes.size));
      if (!this.turnTime) this.back.keep(pushes, rounds.keys);
      else if (this.back.retraced) this.back.undo(pushes);
    }
  }

  /** A component of a velocity, turned round: -V - 2 g t where flights are straight, as v = V + g t turns into -v. */
  turned(x, a) {
    const { worlds, gravity } = this.scene;
    const fall = gravity && worlds.map((A, w) => A.twice(A.mul(gravity[a][w], this.now[w])));
    return x.map((y, w) => (fall ? worlds[w].sub(worlds[w].neg(y), fall[w]) : worlds[w].neg(y)));
  }

  /** Have the bounces of a circle come to their end by now? */
  bouncesNoMore(i) {
    const { contacts: [c] } = this.bounces.get(i);
    if (this.signed(rest(this, i), 'rest', c, `whether ${c.name} bounces still`) > 0) refute(`${c.name} bounces still`);
  }
  /** Step 7: what comes to rest on a level wall or face, or between two, or slides along such a wall, is carried; what was pushed off is not. */
  settle(e, known, { pushed, pushes }) {
    const { scene, k } = this, { carried } = scene, on = new Map(), out = new Map(), flat = new Map();
    const contacts = list => (list ?? []).map(([i, j]) => this.meeting(scene.contact(i, j), i, j)), bouncing = contacts(e.bounces);
    for (const c of bouncing) append(out, c.i, c);
    for (const list of out.values()) bounce(this, list, known, pushes);
    for (const x of [...known.values()].sort((a, b) => a.c.key - b.c.key)) if (x.sign === 0 && x.c.kind === 'wall') append(flat, x.c.i, x.c);
    for (const [i, list] of scene.settles ? flat : []) {
      this.work.charge(300 * list.length ** 2);
      const first = list.find(c => scene.bears(c)), pairs = first ? [] : list.flatMap((c, m) => list.slice(m + 1).map(o => [c, o]));
      const by = first ? [first] : pairs.find(([c, o]) => holds(scene, c, o));
      if (by) on.set(i, by);
    }
    const told = [...contacts(e.settle), ...bouncing], keys = new Set(told.map(c => c.key));
    const begun = [...on.values()].flat().filter(c => !carried.has(c.i)), due = new Set([...begun, ...this.calm].map(c => c.key));
    if (keys.size !== told.length || keys.size !== due.size || [...due].some(key => !keys.has(key))) refute('not these circles settle');
    for (const [i, list] of out) if (on.get(i)?.length !== list.length) refute('not these contacts bounce'); // as all that begin are told
    this.endFlights(begun.map(c => c.i).filter(i => !pushed.has(i)), known);
    for (const i of [...carried.keys()].filter(i => !on.has(i))) { // it falls from now on
      this.shift(i, -1);
      carried.delete(i);
      this.bounces.delete(i);
    }
    for (const [i, by] of on) {
      if (carried.has(i) && !pushed.has(i)) continue;
      if (!carried.has(i)) this.shift(i, 1);
      carried.set(i, by);
      this.turnedAt[i] = k;
      pushed.add(i);
      append(this.rows, i, by); // an isometry maps that too
      if (out.has(i) && !by[1]) flatten(this, by[0]);
      this.rest(...by);
    }
  }
  /** From the frame in which flights are straight to that of the scene, or (-1) back; the flight starts now. */
  shift(i, side) {
    const { worlds } = this.scene, f = this.flights[i], fall = worlds.map((A, w) => this.scene.fallen(A, w, this.now[w]));
    const moved = (x, part, a) => worlds.map((A, w) => (side > 0 ? A.add(x[w], fall[w][part][a]) : A.sub(x[w], fall[w][part][a])));
    this.flights[i] = { ...f, p: f.p.map((x, a) => moved(x, 'by', a)), v: f.v.map((x, a) => moved(x, 'speed', a)) };
  }
  /** What is known of a flight that a wall carries: it lies at gap zero, along the wall; and on a face, or between two, at rest. */
  rest(c, other) {
    const { scene } = this, { exact } = scene, f = this.flights[c.i], wall = scene.walls[c.j - scene.n], none = scene.number(ZERO);
    if (other) {
      f.v = [none, none];
      return;
    }
    if (c.face) {
      if (this.known((A, w) => this.laws(c, A, w).slide(), `whether ${c.name} slides`)) refute(`${c.name} slides along a face, which ends`);
      f.v = [none, none];
    }
    for (const a of [0, 1]) {
      if (exact.sign(wall.n[1 - a][2]) !== 0) continue; // upright along an axis
      const down = scene.signOf(scene.gravity[a]) ?? undecided('which way is down'), from = a ? wall.y0 : wall.x0;
      const reach = scene.worlds.map((A, w) => (wall.face ? A.add(scene.circles[c.i].r[w], wall.thick[w]) : scene.circles[c.i].r[w]));
      f.p[a] = scene.worlds.map((A, w) => (down < 0 ? A.add(from[w], reach[w]) : A.sub(from[w], reach[w])));
      f.v[a] = none;
    }
  }

  moving() { return this.flights.map((_, i) => i).filter(i => !this.fixed[i] && !this.captured[i]); }

  /** @returns {Contact} */
  meeting(c, i, j) {
    if (!c || this.movers(c).some(x => this.captured[x])) refute(`the scene has no contact [${i},${j}] here`);
    return c;
  }


  /** The time at which a circle falls onto one that stands: the one zero about where a decimal says. */
  drop(c, { value, unit }) {
    const { scene } = this, A = scene.full, since = this.since(c), first = since.t[1];
    const [low, high] = [-1n, 1n].map(n => A.sub(A.of(scene.exact.plus(value, unit, n)), first));
    return scene.widen(A.add(first, falling(this.fallingLaws(c, A, 1, since.t).quartic().slice(since.order), low, high, A, `the clock ${c.name}`)));
  }

  /** The time at which the gap of a contact falls through zero. */
  clock(c) {
    const { full } = this.scene, name = `the clock ${c.name}`;
    const law = f => (A, w) => f(this.laws(c, A, w, true), A);
    const laws = this.laws(c, full, 1, true), pulled = this.scene.falls(c);
    if (pulled && this.fromZero(c)) { // and to zero
      const wait = full.div(full.twice(laws.closing()), full.neg(laws.speed())) ?? undecided(`when ${name} hits`);
      return this.scene.widen(full.add(this.startOf(c)[1], wait));
    }
    const slope = this.scene.slope(c), arc = c.kind === 'arc' || slope < 0, zero = (c.hollow || slope < 0) && this.fromZero(c);
    if (zero) {
      const wait = full.div(full.neg(full.twice(laws.closing())), laws.speed()) ?? undecided(`when ${name} hits`);
      return this.scene.widen(full.add(this.startOf(c)[1], wait));
    }
    const disc = this.known(law(l => l.disc()), `whether ${name} hits`);
    const leaves = () => c.kind === 'wall' && !pulled && !(slope < 0) && this.known(law(l => l.closing()), `whether ${name} hits`) > 0;
    if (disc <= 0 || leaves()) refute(`${name} does not hit`);
    if (laws.disc().lo <= 0n) undecided(`when ${name} hits`); // known in exact numbers only
    const root = c.kind === 'wall' && !this.scene.steered(c) ? full.neg(laws.closing()) : full.sqrt(laws.disc());
    const time = (arc ? full.div(full.neg(full.add(laws.closing(), root)), laws.speed())
      : full.div(laws.gap(), full.sub(root, laws.closing()))) ?? undecided(`when ${name} hits`);
    return this.scene.widen(full.add(this.startOf(c)[1], time));
  }

  /** A number lies as a decimal says. */
  decimal(number, { value, unit }, what) {
    for (const n of [1n, -1n]) {
      const s = this.known((A, w) => A.sub(number[w], A.of(this.scene.exact.plus(value, unit, n))), `whether ${what} is as its decimal says`);
      if (s * Number(n) >= 0) refute(`${what} is not as its decimal says`);
    }
  }

  /** Step 3 for one contact. */
  meet(c, tellsTime) {
    const law = name => (A, w) => this.laws(c, A, w)[name]();
    if (c.blunt) refute(`${c.name} are a point and a point: nothing says where they push`);
    if (c.face || c.kind === 'arc') {
      const other = this.scene[c.face ? 'otherFace' : 'otherSide'](c);
      if (!this.within(c)) refute(`${c.name} is beside it, beyond an end`);
      if (other && !c.drops && this.parted(other)) refute(`${c.name} is on the other side`);
      if (c.face && this.k === 0 && this.known(law('height'), `whether the centre of ${c.name} is on it`) <= 0) refute(`${c.name} is not on this side`);
    }
    const from = this.parted(c) ? this.knownAt.get(c.key) : undefined;
    if (tellsTime) { // the gap falls
      if (c.drops) this.stays(c, 'flight', 1);
      this.met.push({ c, sign: -1, lasted: false, from });
      return;
    }
    if (this.signed(law('gap'), 'gap', c, `whether ${c.name} is at gap zero`)) refute(`${c.name} is not at gap zero`);
    const sign = this.signed(law('closing'), 'closing', c, `whether ${c.name} approaches`, true);
    if (this.k && this.scene.slope(c) < 0 && sign === 0) refute(`${c.name} comes from behind`);
    if (c.drops) {
      if (this.k && sign > 0 && c.kind !== 'pocket') refute(`${c.name} comes from behind`);
      if (this.k) this.stays(c, 'flight', sign ? 1 : 2);
      this.met.push({ c, sign, lasted: false });
      return;
    }
    if (this.k && !c.face && sign === 0 && this.signed(law('speed'), 'speed', c, `whether the two of ${c.name} move as one`) <= 0) {
      refute(`${c.name} is at gap zero all the time, or below it, and does not come to it`);
    }
    if (this.k && sign > 0) {
      if (c.kind !== 'pocket') refute(`${c.name} is at gap zero and parts`);
      if (!this.parted(c) && this.known((A, w) => this.laws(c, A, w, true).gap(), `whether ${c.name} was inside`) >= 0) {
        refute(`${c.name} leaves without having entered`);
      }
    }
    this.met.push({ c, sign, lasted: false, from });
  }

  /** Step 4: the instant is not after the end, nor after the reversal. Is the reversal due? */
  ahead(e, ended) {
    const { reverseAt } = this.scene, until = this.until();
    const less = (number, question, what) => {
      const s = this.signed((A, w) => A.sub(number[w], this.now[w]), question, null, what);
      if (s < 0) refute(`it is not so that ${what.replace('whether ', '')}`);
      return s;
    };
    if (until) less(until, 'until', 'whether it comes before the end');
    const due = Boolean(reverseAt && !this.turnTime && less(reverseAt, 'reverse', 'whether it comes before the reversal') === 0);
    if (this.k && !e.turn && !e.met && !ended.length && !due) refute('nothing meets');
    return due;
  }
  /** The end, if it is a time and known by now. */
  until() {
    const { end } = this.certificate;
    if (end.reason === 'horizon') return this.scene.number(end.until);
    if (end.reason !== 'return') return null;
    const half = this.turnTime ?? this.scene.reverseAt;
    return half ? half.map((x, w) => this.scene.worlds[w].twice(x)) : null;
  }

  /** Step 6: circles that are captured rest. */
  capture(caught, known, pushed) {
    for (const i of caught) {
      if (this.flights[i].start === this.k) continue;
      const { rows } = this; // what is proved is of the time before the rounds
      this.rows = null;
      this.endFlights([i], known);
      this.rows = rows;
    }
    for (const i of caught) {
      for (const c of pushed.has(i) ? this.contactsOf(i) : []) { // pushed on a rim that it was to leave, it might enter there
        if (c.kind === 'pocket' && !known.has(c.key) && this.known((A, w) => this.laws(c, A, w).gap(), `whether ${c.name} enters`) === 0) {
          refute(`${c.name} is on the rim and not told`);
        }
      }
    }
    const { gravity, worlds } = this.scene;
    for (const i of caught) { // under gravity it stands from here on in the frame of the scene
      const f = this.flights[i], fall = gravity && worlds.map((A, w) => this.scene.fallen(A, w, this.now[w]).by);
      this.captured[i] = true;
      if (fall) f.p = f.p.map((x, a) => worlds.map((A, w) => A.add(x[w], fall[w][a])));
      f.v = [this.zero, this.zero];
    }
  }
}
