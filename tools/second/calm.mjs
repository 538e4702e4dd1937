// What bounces on a surface, or on two at once, infinitely often; it comes to rest there after a finite time, and meets nothing else meanwhile.
import { refute, undecided } from './base.mjs';
import { fraction } from './exact.mjs';

/** @typedef {import('./scene.mjs').Contact} Contact */
/** @typedef {import('./run.mjs').Run} Run */

/** Do two surfaces hold a circle between them: is what is against gravity strictly between their normals? */
export function holds(scene, c, o) {
  const cross = (A, a, b) => A.sub(A.mul(a[0], b[1]), A.mul(a[1], b[0]));
  const [one, other] = [c, o].map(x => (A, w) => scene.normal(x, A, w)), pull = (A, w) => scene.gravity.map(x => x[w]);
  const signs = [[one, other], [pull, one], [other, pull]].map(([a, b]) => scene.sign((A, w) => cross(A, a(A, w), b(A, w))));
  if (signs.includes(undefined)) undecided(`whether ${c.name} and ${o.name} hold it`);
  return signs[0] !== 0 && signs.every(s => s === signs[0]);
}

/** Of a circle that bounces: what is positive before its bounces have come to their end, and zero there. */
export const rest = (run, i) => (A, w) => {
  const { rise, fall, since } = run.bounces.get(i);
  return A.add(rise[w], A.mul(fall[w], A.sub(run.now[w], since[w])));
};

/** When they have come to their end. */
export function stilled(run, i) {
  const { rise, fall, since } = run.bounces.get(i), A = run.scene.full;
  return run.scene.widen(A.add(since[1], A.div(rise[1], A.neg(fall[1])) ?? undecided('how long it bounces')));
}

/** A circle bounces from now on until it lies still, as its contacts tell: the proof of that; and then it is carried along, without a speed across. */
export function bounce(run, contacts, known, pushes) {
  const { scene } = run, [c, other] = contacts, { i } = c, { worlds } = scene, name = contacts.map(x => x.name).join(' and ');
  const entries = contacts.map(x => known.get(x.key));
  if (!scene.gravity || scene.carried.has(i) || entries.some(x => !(x?.sign > 0))) refute(`${name} does not leave`);
  const one = fraction(1n), lost = worlds.map((A, w) => A.sub(A.of(one), scene.restitution[w]));
  if (other) { // it fell to both since they pushed it last, and is pushed by both again: so it flies as gravity pulls
    const mine = pushes.map(list => list.filter(x => run.movers(x).includes(i))).filter(list => list.length);
    const both = mine.length === 1 && mine[0].length === contacts.length && contacts.every(x => mine[0].some(y => y.key === x.key));
    const since = entries.map(x => x.from), together = since[0] !== undefined && since[0] === since[1];
    if (!both || !together) refute(`${name} does not fly up as it is pulled down`);
  }
  const laws = worlds.map((A, w) => run.laws(c, A, w)), A = scene.full;
  run.bounces.set(i, {
    contacts,
    rise: worlds.map((B, w) => B.twice(laws[w].closing())),
    fall: worlds.map((B, w) => B.mul(laws[w].speed(), lost[w])),
    since: run.now,
  });
  near(run, contacts, A.sub(stilled(run, i)[1], run.now[1]), name);
  for (const x of entries) x.sign = 0;
}

/** Proves that nothing comes near a circle for so long. No two have more energy than all; that grows as gravity does work, at most. */
function near(run, contacts, wait, name) {
  const { scene } = run, A = scene.full, { i } = contacts[0], { bits, zero } = A, one = A.of(fraction(1n)), on = new Set(contacts.map(c => c.j));
  const root = x => { const r = A.isqrt(x.hi << bits) + 1n; return { lo: r, hi: r }; }; // of a number that is not negative, at most
  const squares = ([x, y]) => A.add(A.square(x), A.square(y)), times = (...row) => row.reduce((a, b) => A.mul(a, b));
  const over = w => A.div(one, w) ?? undecided('how heavy a circle is');
  run.work.charge(A.price * 30 * scene.size);
  const there = scene.circles.map((_, k) => {
    const p = run.here(k, 1), v = run.flights[k].v.map(x => x[1]), fall = scene.stands(k) ? null : scene.fallen(A, 1, run.now[1]);
    return fall ? { p: p.map((x, a) => A.add(x, fall.by[a])), v: v.map((x, a) => A.add(x, fall.speed[a])) } : { p, v };
  });
  const movers = scene.circles.map((_, k) => k).filter(k => !run.fixed[k]), sum = f => movers.reduce((s, k) => A.add(s, f(k)), zero);
  const masses = movers.reduce((m, k) => m.set(k, over(scene.circles[k].w[1])), new Map());
  const faster = A.mul(root(squares(scene.gravity.map(x => x[1]))), wait);
  const swing = A.add(root(sum(k => A.mul(masses.get(k), squares(there[k].v)))), A.mul(faster, root(sum(k => masses.get(k)))));
  const way = A.mul(A.add(root(squares(there[i].v)), faster), wait);
  const close = () => undecided(`whether something comes near ${name} while it bounces`);
  for (const [k, circle] of scene.circles.entries()) {
    if (k === i) continue;
    const own = run.fixed[k] ? zero : times(swing, root(circle.w[1]), wait), room = [scene.circles[i].r[1], circle.r[1], way, own].reduce((a, b) => A.add(a, b));
    if (!(A.sign(A.sub(squares(there[k].p.map((x, a) => A.sub(x, there[i].p[a]))), A.square(room))) > 0)) close();
  }
  const beyond = c => { // is it farther from a surface, or from the ends of a face, than it goes?
    const l = run.laws(c, A, 1), off = A.mul(way, scene.walls[c.j - scene.n].length[1]);
    return A.sign(A.sub(l.gap(), A.twice(off))) > 0 || (c.face && [l.foot(), l.far()].some(x => A.sign(A.add(x, off)) < 0));
  };
  for (let j = scene.n; j < scene.firstBow; j++) {
    if (on.has(j)) continue;
    const c = scene.contact(i, j), twin = c.face && scene.otherFace(c);
    if (!(beyond(c) || (twin && (on.has(twin.j) || beyond(twin))))) close();
  }
}

/** Of a flight that goes along a surface from now on: what was across it is left out. */
export function flatten(run, c) {
  const { scene } = run, A = scene.full, f = run.flights[c.i], { n } = scene.walls[c.j - scene.n];
  const [x, y] = n.map(z => z[1]), square = A.add(A.square(x), A.square(y));
  const part = A.div(A.add(A.mul(x, f.v[0][1]), A.mul(y, f.v[1][1])), square) ?? undecided(`how fast ${c.name} leaves`);
  const exact = a => (scene.exact.sign(n[a][2]) === 0 ? f.v[a][2] : null);
  f.v = f.v.map((v, a) => scene.widen(A.sub(v[1], A.mul(part, n[a][1])), exact(a)));
}
