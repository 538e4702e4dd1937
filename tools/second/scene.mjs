// The scene in several worlds, its contacts, and the laws: gap, closing, speed, discriminant.
import { malformed, refute, undecided } from './base.mjs';
import { IntervalWorld } from './interval.mjs';
import { ZERO, fraction } from './exact.mjs';

/**
 * A contact of the scene. `key` orders contacts as pairs of whole numbers.
 * `face`: the wall is a face of a segment; `blunt`: of two points, the second the end of a thin segment.
 * @typedef {{i: number, j: number, kind: 'circle'|'wall'|'pocket', key: number, name: string, face: boolean, blunt: boolean}} Contact
 */

/**
 * A number of the run is an array: one value for each world, [intervals of few bits, intervals of all bits, exact].
 * The first are only there to save time: a sign that they tell is true.
 */
export class Scene {
  constructor(certificate, bits, work) {
    const { exact, scene } = certificate;
    this.exact = exact;
    this.seen = new WeakMap();
    this.full = new IntervalWorld(bits, work);
    this.low = bits > 192 ? new IntervalWorld(96, work) : this.full;
    this.worlds = [this.low, this.full, exact];
    this.sameLow = this.low === this.full;
    for (const world of new Set([this.low, this.full])) {
      for (const [k, root] of exact.roots.entries()) {
        const square = world.of(root);
        if (square.hi <= 0n) malformed(`root r${k + 1} is not the root of a positive number`);
        if (square.lo <= 0n) undecided(`whether root r${k + 1} is that of a positive number`);
        world.roots.push(world.sqrt(square));
      }
    }
    const all = o => Object.fromEntries(Object.entries(o).map(([k, v]) => [k, k === 'id' ? v : this.number(v)]));
    this.circles = scene.circles.map(all);
    this.walls = scene.walls.map(all);
    this.physics(scene);
    this.pockets = scene.pockets.map(all);
    this.half = this.number(fraction(1n, 2n));
    this.physics(scene);
    this.segments(scene.segments, scene.arcs);
    this.n = this.circles.length;
    this.firstBow = this.n + this.walls.length;
    this.arcs = scene.arcs.map(arc => this.arc(arc));
    this.size = this.firstBow + 2 * this.arcs.length;
    this.reverseAt = scene.reverse_at && this.number(scene.reverse_at);
    this.until = certificate.end.reason === 'horizon' ? this.number(certificate.end.until) : null;
    this.check();
  }

  /** An exact number in all worlds. */
  number(e) {
    if (!this.seen.has(e)) {
      this.full.work.keep(300 + Number(this.full.bits) / 4);
      this.seen.set(e, this.worlds.map(world => world.of(e)));
    }
    return this.seen.get(e);
  }

  /** Restitution, gravity, the velocities of walls; and what is a scene with them. */
  physics({ restitution, gravity, settle, reverse_at, reverse_after, pockets, segments, arcs }) {
    const one = fraction(1n), zero = e => this.exact.sign(e) === 0;
    this.restitution = this.number(restitution ?? one);
    this.factor = this.worlds.map((A, w) => A.add(A.of(one), this.restitution[w]));
    this.gravity = gravity && !gravity.every(zero) ? gravity.map(x => this.number(x)) : null;
    this.settles = Boolean(settle && this.gravity);
    /** @type {Map<number, Contact>} the circles that walls carry, each with that contact */ this.carried = new Map();
    for (const wall of this.walls) wall.way = this.way(wall.vx, wall.vy);
    const elastic = zero(this.exact.sub(this.restitution[2], one)), turned = reverse_at || reverse_after;
    const drift = this.walls.some(x => x.way) || segments.some(x => this.way(x.vx && this.number(x.vx), x.vy && this.number(x.vy)));
    if (turned && (!elastic || drift)) malformed('no scene: a run that cannot be turned back is');
    if (settle && (!this.gravity || drift || turned || pockets.length || arcs.length)) malformed('no scene: nothing settles there');
    if (!this.gravity) return;
    const stands = segments.length || arcs.length || pockets.length || this.circles.some(c => zero(c.w[2]));
    if (turned && stands) malformed('no scene: a run that cannot be turned back is, where something stands');
  }
  /** A velocity of a wall or a segment; null for none. */
  way(vx, vy) {
    const way = [vx ?? this.number(ZERO), vy ?? this.number(ZERO)];
    return way.every(x => this.exact.sign(x[2]) === 0) ? null : way;
  }
  /** How far the frame has fallen at a time in which flights are straight, and how fast it is, in the world w. */
  fallen(A, w, time) {
    const speed = this.gravity.map(g => A.mul(g[w], time));
    return { by: speed.map(x => A.mul(A.mul(x, time), this.half[w])), speed };
  }

  /** A number known in the full world, and perhaps in the exact one. */
  widen(full, exact = null) {
    return [this.sameLow ? full : this.low.from(full, this.full.bits), full, exact === null ? null : this.exact.reduced(exact)];
  }

  /** Segments: each is two faces, walls that are met from their left, after the walls; and ends, after the circles. */
  segments(told, arcs) {
    const zero = this.number(ZERO), ends = new Map();
    this.firstFace = this.circles.length + this.walls.length; // and as many as there are ends
    const end = (id, x, y, thick, vx = ZERO, vy = ZERO) => { // those at one place that move alike are one
      const place = [x, y, vx, vy].map(v => this.spelled(v)).join(';'), there = ends.get(place);
      if (!there) {
        const [px, py, ux, uy] = [x, y, vx, vy].map(v => this.number(v));
        ends.set(place, { id, x: px, y: py, r: thick, vx: ux, vy: uy, w: zero, end: true, way: this.way(ux, uy) });
      }
      else {
        const larger = this.sign((A, w) => A.sub(thick[w], there.r[w]));
        if (larger === undefined) undecided('which of two ends at one place is the larger');
        if (larger > 0) there.r = thick;
      }
    };
    for (const { id, ...e } of told) {
      const [x0, y0, x1, y1, length, thick] = [e.x0, e.y0, e.x1, e.y1, e.length, e.r].map(v => this.number(v));
      const way = this.way(e.vx && this.number(e.vx), e.vy && this.number(e.vy)), face = true;
      this.walls.push({ id, x0, y0, x1, y1, length, thick, face, way });
      this.walls.push({ id, x0: x1, y0: y1, x1: x0, y1: y0, length, thick, face, way });
      for (const [x, y] of [[e.x0, e.y0], [e.x1, e.y1]]) end(id, x, y, thick, e.vx, e.vy);
    }
    for (const { id, full, ...e } of arcs) if (!full) for (const [x, y] of [[e.x0, e.y0], [e.x1, e.y1]]) end(id, x, y, zero);
    this.circles.push(...ends.values());
    this.firstFace += ends.size;
  }
  /** An arc: what of its circle lies beyond the chord through its ends, on the side of `across`, which is `far` from its middle, times r. */
  arc({ id, full, ...e }) {
    const [x, y, r] = [e.x, e.y, e.r].map(v => this.number(v)), each = f => this.worlds.map(f);
    if (full) return { id, x, y, r, full, across: [this.number(ZERO), this.number(ZERO)], far: each(A => A.of(fraction(-1n))), ends: [] };
    const from = (a, b) => each((A, w) => A.sub(a[w], b[w]));
    const ends = [[e.x0, e.y0], [e.x1, e.y1]].map(([a, b]) => [from(this.number(a), x), from(this.number(b), y)]);
    const [[ax, ay], [bx, by]] = ends, across = [from(by, ay), from(ax, bx)];
    const far = each((A, w) => A.add(A.mul(across[0][w], ax[w]), A.mul(across[1][w], ay[w])));
    return { id, x, y, r, full, across, far, ends };
  }
  /** Of a contact with a side of an arc: the arc, and whether it is met from within. */
  bow(c) { return { arc: this.arcs[(c.j - this.firstBow) >> 1], hollow: c.hollow }; }

  /** The same text for the same sum of terms. */
  spelled(e) {
    const { den, terms } = this.exact.reduced(e);
    this.full.work.charge(1000 * terms.size);
    return [...terms].sort(([a], [b]) => (a < b ? -1 : 1)).map(([m, x]) => `${m}:${x}`).join() + `/${terms.size ? den : 1n}`;
  }

  /** The sign of what `law` computes in a world: told by the first world that knows it. */
  sign(law) {
    for (let w = this.sameLow ? 1 : 0; w < 3; w++) {
      const s = this.worlds[w].sign(law(this.worlds[w], w));
      if (s !== undefined) return s;
    }
    return undefined;
  }
  signOf(number) { return this.sign((_, w) => number[w]); }

  /** All that makes a scene one; else it is no certificate. */
  check() {
    const demand = (number, signs, what) => {
      const s = typeof number === 'function' ? this.sign(number) : this.signOf(number);
      if (s === undefined) undecided(`the scene: whether ${what}`);
      if (!signs.includes(s)) malformed(`no scene: it is not so that ${what}`);
      return s;
    };
    if (this.reverseAt) demand(this.reverseAt, [1], 'reverse_at is positive');
    if (this.until) demand(this.until, [1], 'the end is positive');
    for (const [k, c] of this.circles.entries()) {
      c.point = demand(c.r, [0, 1], `the radius of circle ${k} is not negative`) === 0;
      c.fixed = demand(c.w, [0, 1], `w of circle ${k} is not negative`) === 0;
      if (c.fixed && !c.end) for (const v of [c.vx, c.vy]) demand(v, [0], `the fixed circle ${k} has no velocity`);
    }
    for (const [k, p] of this.pockets.entries()) demand(p.r, [1], `the radius of pocket ${k} is positive`);
    for (const [k, wall] of this.walls.entries()) {
      demand(wall.length, [1], `the length of wall ${k} is positive`);
      wall.n = [this.worlds.map((A, w) => A.sub(wall.y0[w], wall.y1[w])), this.worlds.map((A, w) => A.sub(wall.x1[w], wall.x0[w]))];
      demand((A, w) => A.sub(A.add(A.square(wall.n[0][w]), A.square(wall.n[1][w])), A.square(wall.length[w])), [0],
        `the length of wall ${k} is the distance of its points`);
    }
    this.bounced = demand(this.restitution, [0, 1], 'the restitution is not negative'); // the sign of what has pushed
    demand((A, w) => A.sub(A.add(A.of(fraction(1n)), A.of(fraction(1n))), this.factor[w]), [0, 1], 'the restitution is at most 1');
    for (const { r, ends, across } of this.arcs) {
      demand(r, [1], 'the radius of an arc is positive');
      for (const [p, q] of ends) {
        demand((A, w) => A.sub(A.add(A.square(p[w]), A.square(q[w])), A.square(r[w])), [0], 'the ends of an arc are on its circle');
      }
      const apart = (A, w) => A.add(A.square(across[0][w]), A.square(across[1][w]));
      if (ends.length) demand(apart, [1], 'an arc begins and ends at two places');
    }
    /** Is there room for circle i on the inside of arc k? */
    this.roomy = this.circles.map(c => this.arcs.map(({ r }) => !c.fixed
      && (this.sign((A, w) => A.sub(r[w], c.r[w])) ?? undecided('whether a circle fits in an arc')) > 0));
    for (const wall of this.walls) {
      if (!wall.face) wall.side = this.circles.map((c, i) => {
        if (c.fixed) return 0;
        const side = this.sign((A, w) => A.add(A.mul(wall.n[0][w], A.sub(c.x[w], wall.x0[w])),
          A.mul(wall.n[1][w], A.sub(c.y[w], wall.y0[w]))));
        return (side ?? undecided(`whether circle ${i} is on wall ${wall.id}`)) || refute(`the centre of circle ${i} is on wall ${wall.id}`);
      });
      /** Does gravity part a circle on the left from it (1), pull it there (-1), or neither? */
      wall.pulls = this.gravity ? this.sign((A, w) => A.add(A.mul(wall.n[0][w], this.gravity[0][w]), A.mul(wall.n[1][w], this.gravity[1][w])))
        ?? undecided(`whether gravity pulls along wall ${wall.id}`) : 0;
      const lean = (A, w) => A.sub(A.mul(wall.n[1][w], this.gravity[0][w]), A.mul(wall.n[0][w], this.gravity[1][w]));
      wall.level = this.settles && (this.sign(lean) ?? undecided(`whether wall ${wall.id} is level`)) === 0;
    }
  }

  /** Is it of a wall to which its circle is pulled? */
  falls(c) {
    if (c.kind !== 'wall' || c.face || this.carried.has(c.i)) return false;
    const { pulls, side } = this.walls[c.j - this.n];
    return pulls * side[c.i] < 0;
  }
  /** Of a face under gravity: is the circle pulled to it (-1), parted from it (1), or neither? Else null. */
  slope(c) { return c.face && this.gravity && !this.carried.has(c.i) ? this.walls[c.j - this.n].pulls : null; }
  /** Can it carry the circle: is it level, and pulls it? */
  bears(c) {
    if (c.kind !== 'wall') return false;
    const { level, pulls, side } = this.walls[c.j - this.n];
    return level && pulls * (c.face ? 1 : side[c.i]) < 0;
  }
  /** Is it of a wall from which the gap does not change as from one that rests? */
  steered(c) { return c.kind === 'wall' && Boolean(this.gravity || this.walls[c.j - this.n].way); }

  /** The contact [i, j], or null if the scene has none such. @returns {Contact | null} */
  contact(i, j) {
    const { circles, n } = this;
    if (!(i >= 0 && i < n && j < this.size && j >= -this.pockets.length)) return null;
    const kind = j < 0 ? 'pocket' : j < n ? 'circle' : j < this.firstBow ? 'wall' : 'arc';
    if (kind === 'circle') {
      const a = circles[i], b = circles[j];
      if (i >= j || (a.fixed && b.fixed) || (a.point && b.point && !b.end)) return null;
    } else if (circles[i].fixed) return null;
    const hollow = kind === 'arc' && (j - this.firstBow) % 2 === 1;
    if (hollow && !this.roomy[i][(j - this.firstBow) >> 1]) return null;
    const face = kind === 'wall' && j >= this.firstFace, blunt = kind === 'circle' && circles[i].point && circles[j].point;
    const drops = () => this.drops(i, j, kind); // as it is now
    return { i, j, kind, key: i * 2 ** 24 + j + 2 ** 23, name: `[${i},${j}]`, face, blunt, hollow, get drops() { return drops(); } };
  }

  /** Does a circle stand, in the frame of the scene: is it fixed there, or carried? */
  stands(i) { return this.circles[i].fixed || this.carried.has(i); }
  /** Of a contact of one that falls and one that stands: which is which; peg -1 for what is no circle. */
  drops(i, j, kind) {
    if (!this.gravity || kind === 'wall') return null;
    if (kind !== 'circle') return { mover: i, peg: -1 };
    if (this.stands(i) === this.stands(j)) return null;
    return this.stands(i) ? { mover: j, peg: i } : { mover: i, peg: j };
  }

  /** The same circle with the other side of the same arc; null where there is no room for it. */
  otherSide(c) { return this.contact(c.i, c.j + (c.hollow ? -1 : 1)); }
  /** The same circle with the other face of the same segment. */
  otherFace(c) { return this.contact(c.i, c.j + ((c.j - this.firstFace) % 2 ? -1 : 1)); }

  /** All contacts of circle i. */
  * contactsOf(i) {
    for (let j = -this.pockets.length; j < this.size; j++) {
      const c = j >= 0 && j < i ? this.contact(j, i) : this.contact(i, j);
      if (c) yield c;
    }
  }

  /** n of a wall, turned to the side on which circle i starts, in the world w */
  normal(c, A, w) {
    const { n, side } = this.walls[c.j - this.n];
    return n.map(x => !side || side[c.i] > 0 ? x[w] : A.neg(x[w])); // a face has one side
  }

  /**
   * The laws for a contact whose first circle is at p with velocity u, the second (if it is one) at q with v, at a time.
   * @param {Contact} c
   */
  laws(c, A, w, p, u, q, v, time) {
    const minus = (a, b) => [A.sub(a[0], b[0]), A.sub(a[1], b[1])];
    const dot = (a, b) => A.add(A.mul(a[0], b[0]), A.mul(a[1], b[1]));
    const radius = this.circles[c.i].r[w];
    if (c.kind === 'wall') {
      const wall = this.walls[c.j - this.n], n = this.normal(c, A, w);
      let place = minus(p, [wall.x0[w], wall.y0[w]]), way = u;
      const plus = (a, b) => [A.add(a[0], b[0]), A.add(a[1], b[1])];
      const falls = this.gravity && !this.carried.has(c.i);
      if (falls) { // the wall flies up, seen from where flights are straight
        const { by, speed } = this.fallen(A, w, time);
        place = plus(place, by);
        way = plus(way, speed);
      }
      if (wall.way) {
        const own = wall.way.map(x => x[w]);
        place = minus(place, own.map(x => A.mul(x, time)));
        way = minus(way, own);
      }
      const closing = () => dot(n, way), height = () => dot(n, place);
      const speed = () => (falls ? dot(n, this.gravity.map(x => x[w])) : A.zero ?? ZERO);
      const reach = wall.face ? A.add(radius, wall.thick[w]) : radius;
      const gap = () => A.twice(A.sub(height(), A.mul(reach, wall.length[w])));
      // along a face: of the centre's foot, from its first point, the same as it moves, and how long the face is
      const along = ([x, y]) => A.sub(A.mul(n[1], x), A.mul(n[0], y)), square = () => A.square(wall.length[w]);
      const foot = () => along(place);
      // and the foot at the zero of the gap, times -2 closing
      const near = () => A.sub(A.mul(along(way), gap()), A.twice(A.mul(closing(), foot())));
      // under gravity the foot after a time
      const later = wait => A.add(foot(), A.mul(A.add(along(way), A.mul(A.mul(along(this.gravity.map(x => x[w])), this.half[w]), wait)), wait));
      return {
        height,
        foot,
        far: () => A.sub(square(), foot()),
        beside: wait => [later(wait), A.sub(square(), later(wait))],
        near,
        beyond: () => A.neg(A.add(A.twice(A.mul(closing(), square())), near())),
        direction: () => n,
        gap,
        closing,
        speed,
        slide: () => along(way),
        disc: () => (falls ? A.sub(A.square(closing()), A.mul(speed(), gap())) : A.square(closing())),
      };
    }
    if (c.kind === 'arc') {
      const { arc, hollow } = this.bow(c), fall = this.gravity && this.fallen(A, w, time);
      const to = minus([arc.x[w], arc.y[w]], p), way = [A.neg(u[0]), A.neg(u[1])];
      const d = fall ? minus(to, fall.by) : to, own = fall ? minus(way, fall.speed) : way;
      const turn = x => (hollow ? A.neg(x) : x), reach = hollow ? A.sub(arc.r[w], radius) : A.add(arc.r[w], radius);
      const pace = A.add(A.square(u[0]), A.square(u[1])), square = () => A.add(A.square(d[0]), A.square(d[1]));
      // positive where the way from the middle, minus `to`, of such a length, leads to within the range
      const range = (to, length) => A.neg(A.add(A.mul(A.add(A.mul(arc.across[0][w], to[0]), A.mul(arc.across[1][w], to[1])), arc.r[w]),
        A.mul(arc.far[w], length)));
      return {
        direction: () => (hollow ? d : [A.neg(d[0]), A.neg(d[1])]),
        gap: () => turn(A.sub(square(), A.square(reach))),
        closing: () => turn(dot(d, own)),
        speed: () => turn(pace),
        disc: () => A.sub(A.mul(pace, A.square(reach)), A.square(A.sub(A.mul(d[0], own[1]), A.mul(d[1], own[0])))),
        within: () => range(d, reach),
        onward: () => range(own, A.zero),
        square,
        widely: length => range(d, length),
        after: wait => range(d.map((x, k) => A.add(x, A.mul(own[k], wait))), reach),
        quartic: () => this.quartic(A, w, d, own, -1, reach).map(turn),
        beyond: () => [d, own, this.halved(w, A, -1)].map((x, k) => A.neg(range(x, k ? A.zero : reach))), // as time goes on
      };
    }
    const pocket = c.kind === 'pocket' && this.pockets[-1 - c.j];
    if (c.drops) return this.dropping(c, A, w, p, u, pocket ? [pocket.x[w], pocket.y[w]] : q, v, time, pocket);
    const d = pocket ? minus([pocket.x[w], pocket.y[w]], p) : minus(q, p);
    const speeds = pocket ? [A.neg(u[0]), A.neg(u[1])] : minus(v, u);
    const reach = () => A.square(pocket ? pocket.r[w] : A.add(radius, this.circles[c.j].r[w]));
    const speed = () => A.add(A.square(speeds[0]), A.square(speeds[1]));
    return {
      direction: () => d,
      gap: () => A.sub(A.add(A.square(d[0]), A.square(d[1])), reach()),
      closing: () => dot(d, speeds),
      speed,
      disc: () => A.sub(A.mul(speed(), reach()), A.square(A.sub(A.mul(d[0], speeds[1]), A.mul(d[1], speeds[0])))),
    };
  }

  /** Half of gravity, or the opposite of that. */
  halved(w, A, side) { return this.gravity.map(x => (side < 0 ? A.neg(A.mul(x[w], this.half[w])) : A.mul(x[w], this.half[w]))); }
  /** The terms of (d + v s + a s²)² - reach², from the constant on, where 2 a is gravity or the opposite of it. */
  quartic(A, w, d, v, side, reach) {
    const a = this.halved(w, A, side), dot = (x, y) => A.add(A.mul(x[0], y[0]), A.mul(x[1], y[1])), square = x => A.add(A.square(x[0]), A.square(x[1]));
    return [A.sub(square(d), A.square(reach)), A.twice(dot(d, v)), A.add(square(v), A.twice(dot(d, a))), A.twice(dot(v, a)), square(a)];
  }
  /** The laws for one that falls and one that stands, a rim among these: the gap is a quartic, `quartic` its terms from the constant on. */
  dropping(c, A, w, p, u, q, v, time, pocket) {
    const first = c.drops.mover === c.i, { by, speed } = this.fallen(A, w, time);
    const [place, way, centre] = first ? [p, u, q] : [q, v, p];
    const from = [0, 1].map(k => A.sub(A.add(place[k], by[k]), centre[k])); // from the one that stands
    const own = pocket ? null : first ? v : u; // of the one that stands: an end may move, and what is carried
    const fast = [0, 1].map(k => A.add(way[k], speed[k])).map((x, k) => (own ? A.sub(x, own[k]) : x));
    const row = this.quartic(A, w, from, fast, 1, pocket ? pocket.r[w] : A.add(this.circles[c.i].r[w], this.circles[c.j].r[w]));
    return {
      direction: () => (first ? from.map(x => A.neg(x)) : from),
      gap: () => row[0],
      closing: () => A.add(A.mul(from[0], fast[0]), A.mul(from[1], fast[1])),
      speed: () => row[2],
      quartic: () => row,
    };
  }
}
