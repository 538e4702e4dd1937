// Witnesses: what shows that a number is zero where exact numbers do not tell.
import { undecided } from './base.mjs';

/**
 * A number is zero or cannot be told from it: do the witnesses of this entry show that it is zero? Else it is not decided.
 * @param {import('./run.mjs').Run} run @param {import('./run.mjs').Contact | null} c null: any
 * @param {boolean} first whether the question is asked in step 3, before the first round
 */
export function witness(run, question, c, what, first = false) {
  run.work.charge(50 * run.witnesses.length);
  const answers = run.witnesses.filter(z => z.question === question
    && (c === null || (z.contact[0] === c.i && z.contact[1] === c.j)));
  if (!answers.length) undecided(what);
  for (const z of answers) {
    run.work.charge(20 * run.met.length);
    const other = z.other === null ? run.met[0] : run.met.find(x => x.c.i === z.other[0] && x.c.j === z.other[1]);
    if (z.how === 'back') {
      if (!run.turnTime) continue;
      const asked = c ?? run.scene.contact(...z.contact);
      if (question !== 'gap' && (question !== 'until' || run.certificate.end.reason !== 'return')) continue;
      if (asked && other && !(other.c.face && other.sign === 0) && run.back.knew(asked.key, other.c.key)) return;
      continue;
    }
    const g = run.isometries[z.how];
    if (c === null) continue;
    const struck = run.rows?.size ? g.struckBy(run.rows) : g.struck;
    if (question === 'rest' && g.maps(c, struck) && run.calm.some(x => x.key === g.contact(c)?.key)) return;
    const image = other && g.maps(c, struck) && g.contact(c)?.key === other.c.key;
    if (question === 'gap' && image) return;
    if (question === 'closing' && first && image && other.sign === 0) return;
    if ((question === 'closing' || question === 'speed') && g.showsRest(question, c, struck)) return;
  }
  undecided(`no witness shows it: ${what}`);
}
