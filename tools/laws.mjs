// The laws of flight, meeting and impulse, in either kind of number.

export class Laws {
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
