// Step 5: groups of known contacts, and rounds of impulses.
import { refute, undecided } from './base.mjs';

/** @typedef {import('./scene.mjs').Contact} Contact */

/** To a list in a map. */
export const append = (map, key, x) => { const list = map.get(key); if (list) list.push(x); else map.set(key, [x]); };

export class Rounds {
  /** @param {import('./run.mjs').Run} run @param {Map<number, import('./run.mjs').Known>} known */
  constructor(run, known, told) {
    Object.assign(this, { run, scene: run.scene, known, told, next: 0 });
    /** @type {Contact[][]} the contacts that push, round by round */ this.pushes = [];
    /** @type {Set<number>} circles that were pushed */ this.pushed = new Set();
    /** @type {Map<number, Contact[][]>} the rows of movable circles so far */ this.rows = new Map();
    this.keys = new Set([...known.values()].filter(x => x.c.kind !== 'pocket').map(x => x.c.key));
    run.rows = this.rows;
  }

  /** Known contacts that hang together through circles, in the order of the scene. */
  groups() {
    const parent = new Map();
    this.run.work.charge(300 * this.known.size);
    const root = i => { while (parent.has(i) && parent.get(i) !== i) i = parent.get(i); return i; };
    const list = [...this.known.values()].sort((x, y) => x.c.key - y.c.key);
    for (const { c } of list) if (c.kind === 'circle') { const a = root(c.i), b = root(c.j); if (a !== b) parent.set(a, b); }
    const groups = new Map();
    for (const x of list) append(groups, root(x.c.i), x);
    return [...groups.values()];
  }

  approaching(group) { return group.filter(x => x.c.kind !== 'pocket' && x.sign < 0); } // in the order of the scene

  all() {
    const { run } = this;
    const active = this.groups().map(group => ({ group, first: this.approaching(group)[0] })).filter(x => x.first);
    active.sort((a, b) => a.first.c.key - b.first.c.key);
    run.endFlights(active.flatMap(({ group }) => group.flatMap(x => x.c.kind === 'circle' ? [x.c.i, x.c.j] : [x.c.i])), this.known);
    for (const { group } of active) {
      for (let list; (list = this.approaching(group)).length;) {
        this.round(group, list, this.told[this.next++] ?? []);
      }
    }
    if (this.next < this.told.length) refute('a round in which nothing approaches');
  }

  round(group, list, told) {
    const { run } = this, { simultaneous, seed } = run.certificate.scene.tie_policy;
    run.work.charge(300 * group.length);
    const byName = new Map(list.map(x => [x.c.name, x]));
    const pushing = new Set(told.map(({ contact: [i, j] }) => byName.get(`[${i},${j}]`)
      ?? refute(`[${i},${j}] does not approach, and is said to push`)));
    if (pushing.size < told.length) refute('a contact pushes twice in a round');
    let block = list;
    if (!simultaneous) {
      block = [list[seed !== null && list.length > 1 ? run.random.below(list.length) : 0]];
      for (const x of pushing) if (x !== block[0]) refute(`it is ${block[0].c.name} that pushes`);
    }
    const contacts = [...pushing].map(x => x.c);
    const impulses = told[0]?.impulse ? this.rightly(contacts, told) : this.solved(contacts);
    for (const [a, s] of impulses.entries()) {
      const sign = this.scene.signOf(s) ?? undecided(`whether ${contacts[a].name} pushes`);
      if (sign <= 0) refute(`${contacts[a].name} does not push`);
    }
    for (const x of block) {
      if (pushing.has(x)) continue;
      const { c } = x;
      const slack = run.signed((A, w) => this.residual(A, w, c, contacts, impulses), 'slack', c, `whether ${c.name} pushes`);
      if (slack < 0) refute(`${c.name} pushes, which is not told`);
    }
    const moved = this.apply(contacts, impulses);
    this.pushes.push(contacts);
    this.note(block.map(x => x.c));
    for (const x of group) {
      if (pushing.has(x)) x.sign = this.scene.bounced; // G s = -(1 + e) u: its closing speed is -e u now
      else if (run.movers(x.c).some(i => moved.has(i))) {
        x.sign = run.signed((A, w) => run.laws(x.c, A, w).closing(), 'closing', x.c, `whether ${x.c.name} approaches`);
      }
    }
  }

  /** The rows of circles grow by a round: of each movable circle, its contacts in the block. */
  note(block) {
    const here = new Map();
    for (const c of block) for (const i of this.run.movers(c)) append(here, i, c);
    for (const [i, list] of here) append(this.rows, i, list);
  }

  /** J of a contact: its direction on j, and against it on i; or that of the wall on i. [circle, vector] */
  jacobian(c, A, w) {
    const d = this.run.laws(c, A, w).direction();
    return c.kind === 'wall' || c.kind === 'arc' ? [[c.i, d]] : [[c.i, d.map(x => A.neg(x))], [c.j, d]];
  }

  /** An entry of G. */
  coupling(A, w, a, b) {
    let sum = null;
    for (const [i, p] of this.jacobian(a, A, w)) for (const [j, q] of this.jacobian(b, A, w)) {
      if (i !== j || this.run.fixed[i]) continue;
      const dot = a === b ? A.add(A.square(p[0]), A.square(p[1])) : A.add(A.mul(p[0], q[0]), A.mul(p[1], q[1]));
      const term = A.mul(this.scene.circles[i].w[w], dot);
      sum = sum === null ? term : A.add(sum, term);
    }
    return sum ?? this.run.zero[w];
  }

  /** (1 + e) u + G s of a contact */
  residual(A, w, c, contacts, impulses) {
    let sum = A.mul(this.scene.factor[w], this.run.laws(c, A, w).closing());
    for (const [b, other] of contacts.entries()) {
      if (this.run.movers(c).some(i => this.run.movers(other).includes(i))) {
        sum = A.add(sum, A.mul(this.coupling(A, w, c, other), impulses[b][w]));
      }
    }
    return sum;
  }

  /** The impulses that are told, if they are right. */
  rightly(contacts, told) {
    const impulses = told.map(p => this.scene.number(p.impulse));
    for (const c of contacts) {
      const s = this.scene.sign((A, w) => this.residual(A, w, c, contacts, impulses));
      if (s === undefined) undecided(`whether the impulse of ${c.name} is as told`);
      if (s) refute(`the impulse of ${c.name} is not as told`);
    }
    return impulses;
  }

  /** G s = -(1 + e) u, by elimination in intervals. */
  solved(contacts) {
    const A = this.scene.full, m = contacts.length, stuck = () => undecided('whether the impulses are determined');
    const rows = contacts.map(a => [...contacts.map(b => this.coupling(A, 1, a, b)),
      A.neg(A.mul(this.scene.factor[1], this.run.laws(a, A, 1).closing()))]);
    for (let k = 0; k < m; k++) for (let r = k + 1; r < m; r++) {
      if (A.sign(rows[r][k]) === 0) continue;
      const factor = A.div(rows[r][k], rows[k][k]) ?? stuck();
      for (let c = k + 1; c <= m; c++) rows[r][c] = A.sub(rows[r][c], A.mul(factor, rows[k][c]));
    }
    const s = [];
    for (let k = m - 1; k >= 0; k--) {
      let sum = rows[k][m];
      for (let c = k + 1; c < m; c++) sum = A.sub(sum, A.mul(rows[k][c], s[c]));
      s[k] = A.div(sum, rows[k][k]) ?? stuck();
    }
    return s.map(x => this.scene.widen(x));
  }

  /** v_i += w_i s J_i. @returns {Set<number>} the circles that were pushed */
  apply(contacts, impulses) {
    const { run, scene } = this, moved = new Set();
    const push = w => { // all in one world; directions do not depend on velocities
      const A = scene.worlds[w], v = new Map();
      for (const [b, c] of contacts.entries()) for (const [i, J] of this.jacobian(c, A, w)) {
        if (run.fixed[i]) continue;
        const ws = A.mul(scene.circles[i].w[w], impulses[b][w]), old = v.get(i) ?? run.flights[i].v.map(x => x[w]);
        v.set(i, old.map((x, k) => A.add(x, A.mul(ws, J[k]))));
      }
      return v;
    };
    const full = push(1), exact = push(2);
    for (const [i, v] of full) {
      run.flights[i].v = v.map((x, k) => scene.widen(x, exact.get(i)[k]));
      run.turnedAt[i] = run.k;
      moved.add(i);
      this.pushed.add(i);
    }
    return moved;
  }
}
