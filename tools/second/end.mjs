// The end of a run, and its final state.
import { refute } from './base.mjs';

/** @param {import('./run.mjs').Run} run */
export function theEnd(run) {
  const { end, scene, final } = run.certificate, { reverseAt } = run.scene;
  Object.assign(run, { met: [], rows: null, witnesses: end.zeros ?? [], calm: [] });
  const last = end.reason === 'events';
  if (last && run.events !== end.limit) refute(`there are ${run.events} events`);
  if (run.due && !last) refute('the reversal is due and not told');
  if (end.reason === 'quiet' && reverseAt && !run.turnTime) refute('the reversal is to come');
  if (end.reason === 'return' && !run.turnTime) refute('there was no reversal');
  const until = run.until();
  if (end.reason === 'horizon' && reverseAt && !run.turnTime
    && run.known((A, w) => A.sub(reverseAt[w], until[w]), 'whether the reversal comes before the end') <= 0) refute('the reversal is not told');
  if (until) { run.now = until; run.cache = []; run.k++; }
  for (const i of run.flights.keys()) for (const c of run.contactsOf(i)) {
    if (c.i === i) run.apart(c, end.reason === 'quiet' ? 'ever' : 'end');
  }
  for (const i of run.bounces.keys()) run.bouncesNoMore(i); // what was not told has come to its end
  run.place = 'the final state';
  run.decimal(run.now, final.time, 'the time');
  for (const [i, row] of final.circles.entries()) {
    for (const a of [0, 1]) {
      const { worlds, gravity } = run.scene, v = run.flights[i].v[a];
      const fall = gravity && !run.scene.stands(i) && !run.captured[i] && worlds.map((A, w) => run.scene.fallen(A, w, run.now[w]));
      const p = worlds.map((A, w) => (fall ? A.add(run.here(i, w)[a], fall[w].by[a]) : run.here(i, w)[a]));
      run.decimal(p, row[a], `${'xy'[a]} of circle ${i}`);
      run.decimal(fall ? v.map((x, w) => worlds[w].add(x, fall[w].speed[a])) : v, row[2 + a], `v${'xy'[a]} of circle ${i}`);
    }
  }
}
