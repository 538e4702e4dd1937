// Isometries, and which circles they map with their past.
import { malformed, refute, undecided } from './base.mjs';
import { ZERO } from './exact.mjs';

export class Isometry {
  /**
   * @param {{matrix: object[], shift: object[], map: number[][]}} given
   * @param {import('./scene.mjs').Scene} scene
   */
  constructor(given, scene, work, name) {
    this.scene = scene;
    this.work = work;
    this.name = name;
    this.matrix = given.matrix.map(x => scene.number(x));
    this.shift = given.shift.map(x => scene.number(x));
    /** @type {Map<number, number>} */ this.map = new Map(given.map);
    /** @type {Map<number, number>} */ this.inverse = new Map(given.map.map(([i, j]) => [j, i]));
    for (const i of given.map.flat()) if (!this.sort(i)) malformed(`${name}: the scene has no thing ${i}`);
    if (this.map.size !== given.map.length) refute(`${name} maps one thing twice`);
    if (this.inverse.size !== given.map.length) refute(`${name} takes two things to one`);
    /** @type {Set<number>} circles whose past is not mapped any more */ this.struck = new Set();
    this.check();
  }

  /** The image of a vector; of a point, if shift is told. */
  image(A, w, [x, y], shift = null) {
    const [a, b, c, d] = this.matrix.map(m => m[w]);
    const out = [A.add(A.mul(a, x), A.mul(b, y)), A.add(A.mul(c, x), A.mul(d, y))];
    return shift ? out.map((z, k) => A.add(z, shift[k][w])) : out;
  }

  /** What an index stands for; '' for nothing. */
  sort(i) {
    const { n, size, pockets, firstFace, firstBow } = this.scene;
    const flat = i < firstFace ? 'wall' : i < firstBow ? 'face' : i < size ? 'arc' : '';
    return i >= 0 ? (i < n ? 'circle' : flat) : (-1 - i < pockets.length ? 'pocket' : '');
  }

  /** All that is said of it holds exactly. */
  check() {
    const { scene, name, shift } = this;
    const zero = (law, what) => {
      const s = scene.sign(law);
      if (s === undefined) undecided(`${name}: whether ${what}`);
      if (s) refute(`${name}: it is not so that ${what}`);
    };
    const [a, b, c, d] = this.matrix, one = scene.number({ den: 1n, terms: new Map([[0n, 1n]]) });
    zero((A, w) => A.sub(A.add(A.square(a[w]), A.square(c[w])), one[w]), 'a² + c² = 1');
    zero((A, w) => A.sub(A.add(A.square(b[w]), A.square(d[w])), one[w]), 'b² + d² = 1');
    zero((A, w) => A.add(A.mul(a[w], b[w]), A.mul(c[w], d[w])), 'a b + c d = 0');
    const { circles, walls, pockets, n } = scene, rests = [scene.number(ZERO), scene.number(ZERO)];
    const falls = what => { // where something that stands is mapped
      for (const k of scene.gravity ? [0, 1] : []) same((A, w) => this.image(A, w, scene.gravity.map(x => x[w]))[k], scene.gravity[k], what);
    };
    const same = (x, y, what) => zero((A, w) => A.sub(x(A, w), y[w]), what);
    for (const [i, j] of this.map) {
      const kind = this.sort(i), what = `${i} is mapped to ${j}`;
      if (kind !== this.sort(j)) refute(`${name}: ${what}, which is another kind`);
      if (kind === 'arc') { // the same side of one as large, about the image of its middle, beyond the image of its chord
        const [own, other] = [i, j].map(k => scene.arcs[(k - scene.firstBow) >> 1]);
        if ((i - j) % 2) refute(`${name}: ${what}, which is the other side of an arc`);
        for (const k of [0, 1]) {
          same((A, w) => this.image(A, w, [own.x[w], own.y[w]], shift)[k], [other.x, other.y][k], what);
          same((A, w) => this.image(A, w, [own.across[0][w], own.across[1][w]])[k], other.across[k], what);
        }
        same((A, w) => own.r[w], other.r, what);
        same((A, w) => own.far[w], other.far, what);
        falls(what);
        continue;
      }
      if (kind === 'face') { // to the side of the image's normal, its middle there, as thick, and as it moves
        const p = walls[i - n], q = walls[j - n], own = p.way ?? rests, other = q.way ?? rests;
        for (const k of [0, 1]) {
          same((A, w) => this.image(A, w, [own[0][w], own[1][w]])[k], other[k], what);
          same((A, w) => this.image(A, w, [p.n[0][w], p.n[1][w]])[k], q.n[k], what);
          const ends = (A, w, { x0, y0, x1, y1 }) => [A.add(x0[w], x1[w]), A.add(y0[w], y1[w])];
          zero((A, w) => {
            const moved = A.add(this.image(A, w, ends(A, w, p))[k], A.twice(shift[k][w]));
            return A.sub(moved, ends(A, w, q)[k]);
          }, what);
        }
        falls(what);
        same((A, w) => p.thick[w], q.thick, what);
        continue;
      }
      if (kind === 'wall') {
        const p = walls[i - n], q = walls[j - n];
        const across = (A, w, [x, y]) => A.add(A.mul(q.n[0][w], x), A.mul(q.n[1][w], y));
        zero((A, w) => {
          const [x, y] = this.image(A, w, [p.x0[w], p.y0[w]], shift);
          return across(A, w, [A.sub(x, q.x0[w]), A.sub(y, q.y0[w])]);
        }, what);
        zero((A, w) => across(A, w, this.image(A, w, [A.sub(p.x1[w], p.x0[w]), A.sub(p.y1[w], p.y0[w])])), what);
        const ways = [[p.way, q.way], [scene.gravity, scene.gravity]];
        for (const [own, other] of ways.filter(way => way[0] || way[1])) { // and that as time goes on
          zero((A, w) => {
            const to = (other ?? rests).map(x => x[w]);
            const moved = this.image(A, w, (own ?? rests).map(x => x[w]));
            return across(A, w, moved.map((x, k) => A.sub(x, to[k])));
          }, what);
        }
        continue;
      }
      const p = kind === 'circle' ? circles[i] : pockets[-1 - i], q = kind === 'circle' ? circles[j] : pockets[-1 - j];
      for (const k of [0, 1]) {
        same((A, w) => this.image(A, w, [p.x[w], p.y[w]], shift)[k], [q.x, q.y][k], what);
        if (kind === 'circle') same((A, w) => this.image(A, w, [p.vx[w], p.vy[w]])[k], [q.vx, q.vy][k], what);
      }
      if (kind === 'pocket' || p.fixed) falls(what);
      same((A, w) => p.r[w], q.r, what);
      if (kind === 'circle') same((A, w) => p.w[w], q.w, what);
    }
  }

  /** The image of a contact, or null. @param {import('./scene.mjs').Contact} c */
  contact(c) {
    const i = this.map.get(c.i), j = this.map.get(c.j);
    if (i === undefined || j === undefined) return null;
    return c.kind === 'circle' && j < i ? this.scene.contact(j, i) : this.scene.contact(i, j);
  }

  /**
   * The circles struck out after these rounds of an instant, besides those struck out before.
   * @param {Map<number, import('./scene.mjs').Contact[][]>} rows of circles, of this instant
   */
  struckBy(rows) {
    const out = new Set(this.struck), concerned = new Set();
    for (const i of rows.keys()) for (const k of [i, this.inverse.get(i)]) if (this.map.has(k) && !out.has(k)) concerned.add(k);
    this.work.charge(200 * (rows.size + concerned.size));
    for (const i of concerned) if (!this.rowMapped(rows.get(i) ?? [], rows.get(this.map.get(i)) ?? [])) out.add(i);
    for (let before = -1; before < out.size;) { // until none follows from another
      before = out.size;
      for (const i of concerned) {
        this.work.charge(0);
        if (!out.has(i) && (rows.get(i) ?? []).some(round => round.some(c => out.has(c.i) || out.has(c.j)))) out.add(i);
      }
    }
    return out;
  }

  rowMapped(row, image) {
    return row.length === image.length && row.every((round, k) => {
      this.work.charge(round.length * 200);
      const keys = new Set(image[k].map(c => c.key));
      return round.length === image[k].length && round.every(c => keys.has(this.contact(c)?.key));
    });
  }

  /** Does it map the circles of a contact with their past? */
  maps(c, struck) {
    return this.map.has(c.i) && this.map.has(c.j) && !struck.has(c.i) && !struck.has(c.j);
  }

  /** Does it show that a closing speed or relative velocity is zero, by itself? */
  showsRest(question, c, struck) {
    const { scene } = this;
    const isZero = law => scene.worlds[2].sign(law(scene.worlds[2], 2)) === 0;
    if (c.kind === 'wall') {
      if (question !== 'closing' || scene.steered(c) || this.map.get(c.i) !== c.i || struck.has(c.i)) return false;
      const { n } = scene.walls[c.j - scene.n]; // turned or not: -n goes to n then
      return [0, 1].every(k => isZero((A, w) => A.add(this.image(A, w, [n[0][w], n[1][w]])[k], n[k][w])));
    }
    if (c.kind !== 'circle') return false;
    const [a, b, d, e] = this.matrix.map(m => m[2]), A = scene.worlds[2];
    const one = { den: 1n, terms: new Map([[0n, 1n]]) };
    if (![b, d, A.sub(a, one), A.sub(e, one)].every(x => A.sign(x) === 0)) return false;
    return (this.map.get(c.i) === c.j && !struck.has(c.i)) || (this.map.get(c.j) === c.i && !struck.has(c.j));
  }
}
