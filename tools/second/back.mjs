// The way back: which instants of the way out have been undone.

import { append } from './rounds.mjs';

/** @typedef {{pushes: Map<number, string[]>, known: Set<number>}} Kept */

export class WayBack {
  constructor() { /** @type {Kept[]} */ this.kept = []; this.retraced = true; }

  /**
   * @param {import('./scene.mjs').Contact[][]} rounds contacts that push @param {boolean[]} fixed
   * @returns {Map<number, string[]>} for each movable circle that is pushed, by what in each of its rounds
   */
  static pushes(rounds, fixed) {
    const out = new Map();
    for (const round of rounds) {
      const here = new Map();
      for (const c of round) for (const i of c.kind === 'circle' ? [c.i, c.j] : [c.i]) {
        if (!fixed[i]) append(here, i, c.key);
      }
      for (const [i, keys] of here) append(out, i, keys.sort((a, b) => a - b).join());
    }
    return out;
  }

  keep(pushes, known) { this.kept.push({ pushes, known }); }

  undo(pushes) {
    const last = this.kept.pop();
    const same = last && last.pushes.size === pushes.size && [...pushes].every(([i, rounds]) => {
      const out = last.pushes.get(i);
      return out && out.length === rounds.length && rounds.every((r, k) => r === out[out.length - 1 - k]);
    });
    if (!same) this.retraced = false;
  }

  /** Were both known at the last instant that is not undone? To be asked on the way back. */
  knew(a, b) {
    const last = this.kept.at(-1);
    return Boolean(this.retraced && last && last.known.has(a) && last.known.has(b));
  }
}
