// What proves a number zero: the past computed again in exact numbers, an isometry, the way back.
import { E, Exact, doubt, malformed, number, refuse, roots } from "./numbers.mjs";

export const key = (c) => `${c[0]},${c[1]}`;
export const inOrder = (a, b) => a[0] - b[0] || a[1] - b[1];
export const isInt = Number.isInteger;

// Expects of its heir: told, scene, n, rows, coming, source, listed, levels, stood, grazed, memo, isometries, exact.
export class Witnesses {
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
