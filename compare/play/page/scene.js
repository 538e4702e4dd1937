// The scene as it is edited: numbers as exact text, every change kept for undo.
export const KINDS = {
  circle: { keys: ["x", "y", "r", "vx", "vy", "m"], letter: "c", name: "disc" },
  wall: { keys: ["x0", "y0", "x1", "y1", "vx", "vy"], letter: "w", name: "wall" },
  segment: { keys: ["x0", "y0", "x1", "y1", "r"], letter: "s", name: "segment" },
  polygon: { keys: ["points", "r"], letter: "g", name: "polygon" },
  arc: { keys: ["x", "y", "r", "x0", "y0", "x1", "y1"], letter: "a", name: "arc" },
  pocket: { keys: ["x", "y", "r"], letter: "p", name: "pocket" },
};
const DEFAULTS = { r: "0", vx: "0", vy: "0", m: "1" };
export const MOST_THINGS = 400; // of each kind; the engine's side has the same limit
export const MOST_CORNERS = 100; // of one polygon
export const MOST_LETTERS = 400; // of one number
const MOST_KEPT = 200; // changes that can be undone

// The double nearest to a number in the grammar of scene files, to draw it; NaN where it is not one.
export function value(text) {
  const source = String(text);
  if (source.length > MOST_LETTERS) return NaN;
  const tokens = source.match(/\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+|\*\*|sqrt|oo|[-+*/()]|\S/g) ?? [];
  let at = 0, depth = 0;
  const next = (token) => tokens[at] === token && ++at > 0;
  const sum = () => {
    let found = product();
    for (;;) {
      if (next("+")) found += product();
      else if (next("-")) found -= product();
      else return found;
    }
  };
  const product = () => {
    let found = signed();
    for (;;) {
      if (next("*")) found *= signed();
      else if (next("/")) found /= signed();
      else return found;
    }
  };
  const signed = () => (next("-") ? -signed() : next("+") ? signed() : power());
  const power = () => {
    const base = atom();
    return next("**") ? base ** signed() : base;
  };
  const atom = () => {
    if (++depth > 100) return NaN;
    if (next("sqrt")) {
      if (!next("(")) return NaN;
      const found = sum();
      return next(")") ? Math.sqrt(found) : NaN;
    }
    if (next("(")) {
      const found = sum();
      return next(")") ? found : NaN;
    }
    return tokens[at] === undefined || !/^[\d.]/.test(tokens[at]) ? NaN : Number(tokens[at++]);
  };
  const found = sum();
  return at === tokens.length ? found : NaN;
}

// A short decimal near a number: to a digit that a pixel shows.
export function rounded(x, pixel) {
  const digits = Math.min(12, Math.max(0, Math.ceil(-Math.log10(pixel))));
  const text = x.toFixed(digits);
  return Number(text) === 0 ? "0" : text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

// A scene of which everything is as it should be, from anywhere; throws a sentence where it is not.
export function checked(data) {
  if (typeof data !== "object" || data === null || Array.isArray(data)) throw new Error("the scene is no object");
  known(data, [...TOP, ...Object.keys(KINDS)], "the scene");
  const scene = { name: text(data.name ?? "mine", "name"), tie_policy: text(data.tie_policy ?? "simultaneous", "tie_policy") };
  for (const key of ["reverse_at", "until", "restitution"]) if (data[key] !== undefined) scene[key] = text(data[key], key);
  if (data.gravity !== undefined) {
    if (!Array.isArray(data.gravity) || data.gravity.length !== 2) throw new Error("gravity is no pair of numbers");
    scene.gravity = data.gravity.map((part) => text(part, "gravity"));
  }
  for (const key of ["events", "reverse_after"]) if (Number.isInteger(data[key])) scene[key] = data[key];
  if (data.capture === true) scene.capture = true;
  for (const [kind, { keys, name }] of Object.entries(KINDS)) {
    const rows = data[kind] ?? [];
    if (!Array.isArray(rows)) throw new Error(`${kind} is no list`);
    if (rows.length > MOST_THINGS) throw new Error(`the page plays at most ${MOST_THINGS} ${name}s, and here are ${rows.length.toLocaleString("en")}`);
    scene[kind] = rows.map((row) => {
      if (typeof row !== "object" || row === null) throw new Error(`a ${name} is no object`);
      const whole = kind === "arc" && row.full === true; // of a full circle there are no ends
      const own = whole ? keys.slice(0, 3) : keys;
      known(row, ["id", "point", ...(kind === "arc" ? ["full"] : []), ...own], `a ${name}`);
      const thing = { id: text(row.id, "id", 64) };
      if (whole) thing.full = true;
      for (const key of own) thing[key] = key === "points" ? corners(row.points, `${name} ${thing.id}`) : text(row[key] ?? DEFAULTS[key], `${name} ${thing.id}: ${key}`);
      if (row.point === true) thing.point = true;
      return thing;
    });
  }
  return scene;
}

const TOP = ["name", "tie_policy", "description", "source", "reverse_at", "until", "events", "reverse_after", "capture", "restitution", "gravity"];

// What the page cannot draw is refused by name: a scene without it would be another.
function known(row, keys, where) {
  for (const key of Object.keys(row)) if (!keys.includes(key)) throw new Error(`${where} has ${key.slice(0, 40)}, which this page does not draw yet`);
}

function corners(found, where) {
  if (!Array.isArray(found) || found.length < 3) throw new Error(`${where} has no three corners`);
  if (found.length > MOST_CORNERS) throw new Error(`${where} has ${found.length.toLocaleString("en")} corners; the page draws at most ${MOST_CORNERS}`);
  return found.map((point, k) => {
    if (!Array.isArray(point) || point.length !== 2) throw new Error(`${where}: corner ${k + 1} is no pair of numbers`);
    return point.map((part) => text(part, `${where}: corner ${k + 1}`));
  });
}

function text(found, where, most = MOST_LETTERS) {
  if (typeof found !== "string" && !Number.isInteger(found)) throw new Error(`${where} is no text`);
  const told = String(found);
  if (!told || told.length > most) throw new Error(`${where} has ${told.length.toLocaleString("en")} characters; 1 to ${most}`);
  return told;
}

export const stands = (wall) => wall.vx === "0" && wall.vy === "0";

// The scene as a file has it: no empty lists, and no thickness where there is none.
export function plain(scene) {
  const told = structuredClone(scene);
  for (const kind of ["wall", "segment", "polygon", "arc", "pocket"]) if (!told[kind].length) delete told[kind];
  for (const thing of [...(told.segment ?? []), ...(told.polygon ?? [])]) if (thing.r === "0") delete thing.r;
  for (const thing of told.wall ?? []) if (stands(thing)) delete thing.vx, delete thing.vy;
  if (told.restitution === "1") delete told.restitution;
  if (told.gravity?.every((part) => part === "0")) delete told.gravity;
  return told;
}

export class Model extends EventTarget {
  constructor(scene) {
    super();
    [this.scene, this.before, this.after, this.chosen] = [scene, [], [], null];
  }

  // Another scene; what was there can be undone.
  replace(scene) {
    this.keep();
    this.scene = scene;
    this.choose(null);
    this.tell("scene");
  }

  // Keeps the scene as it is now, before a change.
  keep() {
    this.before.push(structuredClone(this.scene));
    if (this.before.length > MOST_KEPT) this.before.shift();
    this.after.length = 0;
  }

  // Nothing came of a change that was begun.
  forget() {
    this.before.pop();
    this.tell("change");
  }

  change(act) {
    this.keep();
    act(this.scene);
    this.tell("change");
  }

  undo() { this.step(this.before, this.after); }
  redo() { this.step(this.after, this.before); }

  step(from, to) {
    if (!from.length) return;
    to.push(this.scene);
    this.scene = from.pop();
    if (this.chosen && !this.thing()) this.chosen = null;
    this.tell("change");
  }

  tell(what) { this.dispatchEvent(new CustomEvent("told", { detail: what })); }

  // The things in the order of the list: [kind, place].
  all() {
    return Object.keys(KINDS).flatMap((kind) => this.scene[kind].map((_, k) => [kind, k]));
  }

  thing(chosen = this.chosen) { return chosen && this.scene[chosen[0]]?.[chosen[1]]; }

  choose(chosen) {
    this.chosen = chosen;
    this.tell("choice");
  }

  add(kind, values) {
    const letter = KINDS[kind].letter;
    const used = new Set(this.all().map((one) => this.thing(one).id));
    let number = 1;
    while (used.has(letter + number)) number++;
    this.change((scene) => scene[kind].push({ id: letter + number, ...values }));
    this.choose([kind, this.scene[kind].length - 1]);
  }

  remove() {
    if (!this.chosen) return;
    const [kind, k] = this.chosen;
    this.chosen = null;
    this.change((scene) => scene[kind].splice(k, 1));
    this.tell("choice");
  }
}

// An arc: its middle, its radius, the angle at which it begins and through which it goes, counter-clockwise.
export function bow(arc) {
  const [x, y, r] = [value(arc.x), value(arc.y), value(arc.r)];
  if (arc.full) return [x, y, r, 0, 2 * Math.PI];
  const turn = (key) => Math.atan2(value(arc[`y${key}`]) - y, value(arc[`x${key}`]) - x);
  const [from, to] = [turn(0), turn(1)];
  return [x, y, r, from, to > from ? to - from : to - from + 2 * Math.PI];
}

// A place on it, by a share of its way.
export function onBow([x, y, r, from, way], share) {
  return [x + r * Math.cos(from + share * way), y + r * Math.sin(from + share * way)];
}

export function described(kind, thing) {
  if (kind === "circle") return `${thing.m === "oo" ? "fixed disc" : "disc"} ${thing.id} at (${thing.x}, ${thing.y}), radius ${thing.r}`;
  if (kind === "pocket") return `pocket ${thing.id} at (${thing.x}, ${thing.y}), radius ${thing.r}`;
  if (kind === "arc") return `${thing.full ? "ring" : "arc"} ${thing.id} about (${thing.x}, ${thing.y}), radius ${thing.r}${thing.full ? "" : `, from towards (${thing.x0}, ${thing.y0}) to (${thing.x1}, ${thing.y1})`}`;
  if (kind === "polygon") return `polygon ${thing.id} of ${thing.points.length} corners from (${thing.points[0].join(", ")})`;
  return `${KINDS[kind].name} ${thing.id} from (${thing.x0}, ${thing.y0}) to (${thing.x1}, ${thing.y1})`;
}
