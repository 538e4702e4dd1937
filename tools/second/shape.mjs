// From JSON to a certificate: shapes, the texts of numbers, and limits. All that is wrong here is "no certificate".
import { createHash } from 'node:crypto';
import { malformed } from './base.mjs';
import { ExactWorld } from './exact.mjs';

const LIMITS = { circles: 1000, roots: 99, bits: 1 << 20, pairs: 2 ** 20, work: 2 ** 30 };

const text = (v, where) => typeof v === 'string' ? v : malformed(`${where} is no text`);
const list = (v, where) => Array.isArray(v) ? v : malformed(`${where} is no list`);
const whole = (v, where, least = -Infinity) =>
  typeof v === 'number' && v >= least ? v : malformed(`${where} is no whole number, or too small`);

/** An object with such fields; a name that ends in "?" may be left out. */
function record(v, where, fields) {
  if (!(v instanceof Map)) malformed(`${where} is no object`);
  const out = {};
  for (const [name, read] of Object.entries(fields)) {
    const key = name.replace('?', '');
    if (v.has(key)) out[key] = read(v.get(key), `${where}.${key}`);
    else if (key === name) malformed(`${where} has no ${key}`);
  }
  for (const key of v.keys()) if (!Object.hasOwn(out, key)) malformed(`${where} has a key too many`);
  return out;
}

/** A list of n things. */
const tuple = (v, where, n) => list(v, where).length === n ? v : malformed(`${where} is not of length ${n}`);
const listOf = (read, least = 0) => (v, where) =>
  list(v, where).length >= least ? v.map((x, k) => read(x, `${where}[${k}]`)) : malformed(`${where} is empty`);
/** [i, j], i from 0 on; what the two are is not asked here */
const contact = (v, where) => { tuple(v, where, 2); return [whole(v[0], where, 0), whole(v[1], where)]; };

const QUESTIONS = ['gap', 'closing', 'disc', 'speed', 'slack', 'until', 'reverse', 'rest'];
function zero(v, where) {
  if (list(v, where).length !== 4) tuple(v, where, 3);
  const [question, c, how, other] = v;
  if (!QUESTIONS.includes(question)) malformed(`${where} asks for nothing that is known`);
  if (how !== 'back') whole(how, where, 0);
  return { question, contact: contact(c, where), how, other: v.length === 4 ? contact(other, where) : null };
}

/** A value of JSON in canonical form (RFC 8785): keys in order, no spaces. Numbers are whole. */
function canonical(v) {
  if (v instanceof Map) return `{${[...v.keys()].sort().map(k => `${canonical(k)}:${canonical(v.get(k))}`).join()}}`;
  if (Array.isArray(v)) return `[${v.map(canonical).join()}]`;
  if (typeof v === 'string' && !v.isWellFormed()) malformed('half a character in a text of the scene');
  return JSON.stringify(v);
}

/**
 * @param {unknown} json @param {import('./base.mjs').Work} work
 * @returns the certificate, its numbers exact, and the exact world they belong to
 */
export function readCertificate(json, work) {
  const exact = new ExactWorld(work);
  /** Short texts are read once: a file of 16 MiB may repeat them a million times. */
  const once = (read, seen = new Map()) => (v, where) => {
    if (text(v, where).length > 40) return read(v);
    if (!seen.has(v)) { work.keep(500); seen.set(v, read(v)); }
    return seen.get(v);
  };
  const number = once(v => exact.parse(v)), decimal = once(v => exact.decimal(v));
  const ofScene = once(v => exact.parse(v, own));
  const isTrue = (v, where) => v === true || malformed(`${where} is not true`);

  if (!(json instanceof Map)) malformed('it is no object');
  if (json.get('format') !== 'truebreak/certificate-3') malformed('the format is not truebreak/certificate-3');
  // The roots come first, those of the scene before the others: a number of the scene may use the former, any other all of
  // them, and the k-th root those before it.
  if (!(json.get('scene') instanceof Map)) malformed('the scene is no object');
  const rootsOfScene = list(json.get('scene').get('roots') ?? [], 'scene.roots'), own = rootsOfScene.length;
  const roots = [...rootsOfScene, ...list(json.get('roots'), 'roots')];
  if (roots.length > LIMITS.roots) malformed('more than 99 roots');
  for (const [k, v] of roots.entries()) exact.roots.push(exact.parse(text(v, 'roots'), k));

  const push = (v, where) => {
    if (list(v, where).length !== 3) return { contact: contact(v, where), impulse: null };
    return { contact: contact(v.slice(0, 2), where), impulse: number(v[2], where) };
  };
  const pushes = listOf(push, 1);
  const round = (v, where) => {
    const read = pushes(v, where);
    if (new Set(read.map(p => p.impulse === null)).size > 1) malformed(`${where} tells some impulses, not all`);
    return read;
  };
  const of = fields => (v, where) => record(v, where, fields);
  const numbers = names => Object.fromEntries(names.split(' ').map(name => [name, ofScene]));
  const reason = v => ['quiet', 'horizon', 'return', 'events', 'stopped'].includes(v) ? v : malformed('no such end');
  const policy = (v, where) => {
    const parts = /^(?:(simultaneous)|sequential(?::order=scene|:seed=([0-9]{1,18}))?)$/.exec(text(v, where));
    if (!parts || v.endsWith('\n')) malformed('no such tie_policy');
    return { simultaneous: Boolean(parts[1]), seed: parts[2] === undefined ? null : BigInt(parts[2]) };
  };
  const four = read => (v, where) => tuple(v, where, 4).map(x => read(x, where));
  const two = read => (v, where) => tuple(v, where, 2).map(x => read(x, where));

  const c = record(json, 'the certificate', {
    format: text,
    writer: text,
    roots: v => v,
    scene: of({
      'roots?': v => v, tie_policy: policy,
      'reverse_after?': (v, where) => whole(v, where, 1), 'reverse_at?': ofScene,
      'restitution?': ofScene, 'gravity?': two(ofScene), 'settle?': isTrue,
      'capture?': (v, where) => typeof v === 'boolean' ? v : malformed(`${where} is neither true nor false`),
      circles: listOf(of({ id: text, ...numbers('x y r vx vy w') }), 1),
      'walls?': listOf(of({ id: text, ...numbers('x0 y0 x1 y1 length vx? vy?') })),
      'pockets?': listOf(of({ id: text, ...numbers('x y r') })),
      'segments?': listOf(of({ id: text, ...numbers('x0 y0 x1 y1 length r vx? vy?') })),
      'arcs?': listOf(of({ id: text, ...numbers('x y r x0? y0? x1? y1?') })),
    }),
    isometries: listOf(of({
      matrix: four(number),
      shift: two(number),
      map: listOf((v, where) => tuple(v, where, 2).map(x => whole(x, where))),
    })),
    bits: (v, where) => whole(v, where, 1),
    instants: listOf(of({
      time: decimal, 'exact?': number, 'met?': listOf(contact, 1), 'turn?': isTrue,
      'rounds?': listOf(round), 'enter?': listOf(contact), 'settle?': listOf(contact), 'bounces?': listOf(contact),
      'zeros?': listOf(zero),
    }), 1),
    end: of({ reason, 'until?': number, 'limit?': (v, where) => whole(v, where, 1), 'zeros?': listOf(zero) }),
    final: of({ time: decimal, circles: listOf(four(decimal)) }),
  });

  const { scene, end } = c, n = scene.circles.length;
  scene.walls ??= [];
  scene.pockets ??= [];
  scene.segments ??= [];
  scene.arcs ??= [];
  for (const arc of scene.arcs) {
    const told = ['x0', 'y0', 'x1', 'y1'].filter(key => key in arc).length;
    if (told % 4) malformed('an arc with some of its ends');
    arc.full = told === 0;
  }
  const pairs = n * (n + scene.walls.length + scene.pockets.length + 4 * (scene.segments.length + scene.arcs.length));
  if (n > LIMITS.circles || pairs > LIMITS.pairs) malformed('too many circles, walls and pockets');
  if (c.bits > LIMITS.bits || pairs * c.bits > LIMITS.work) malformed('too many bits');
  if (scene.reverse_after !== undefined && scene.reverse_at !== undefined) malformed('two reversals');
  if (end.reason === 'horizon' && !end.until) malformed('a horizon without until');
  if (end.reason === 'events' && !end.limit) malformed('events without limit');
  if (c.final.circles.length !== n) malformed('final tells of other circles than the scene');
  const ids = [...scene.circles, ...scene.walls, ...scene.pockets, ...scene.segments, ...scene.arcs].map(x => x.id);
  if (new Set(ids).size !== ids.length) malformed('an id comes twice');
  if (c.instants.some((e, k) => k && !(e.met || e.exact || e.turn || e.settle))) malformed('an instant without a time');
  for (const { zeros = [] } of [...c.instants, end]) {
    for (const { how } of zeros) if (how !== 'back' && how >= c.isometries.length) malformed(`there is no isometry ${how}`);
  }
  const digest = createHash('sha256').update(canonical(json.get('scene')), 'utf8').digest('hex');
  const named = ['segments', 'arcs'].filter(kind => json.get('scene').has(kind));
  return { ...c, exact, digest, named };
}
