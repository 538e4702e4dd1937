// What an instant does: rounds of impulses by the tie policy, then entries into pockets.
import { I, doubt, refuse } from "./numbers.mjs";
import { Witnesses, inOrder, key } from "./witnesses.mjs";

export class Impulses extends Witnesses {
  see(c) { return this.laws.see(this.fly, c); }
  get(c) { return this.coming.get(key(c)) ?? null; }
  set(c, known) { this.coming.set(key(c), known); }
  signOf(question, c, value) {
    const sign = I.sign(value);
    if (sign !== null) return sign;
    this.zero(question, c);
    return 0;
  }

  placesOf(c) {
    return new Map(c.filter((i) => i >= 0 && i < this.n).map((i) => [i, this.rows[i].length]));
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
}
