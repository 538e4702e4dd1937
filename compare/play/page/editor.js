// The canvas on which a scene is drawn: what is under the pointer, what a drag does, and the keys.
import { MOST_CORNERS, bow, described, onBow, rounded, value } from "./scene.js";

const NEAR = 12; // pixels within which a handle is meant; a finger's is larger
const FINGER = 22;
const STILL = 2; // pixels by which a click may stray
const ARROW = 26; // pixels from the rim to where a disc at rest is thrown from
const MARGIN = 0.12; // share of the scene's size around it
const STEPS = 180; // of an arc that is drawn
const LEAST = 1e-9; // a scene of one point has some size all the same

export class Editor {
  // `cued` is called once the cue was let go. `corners`: those clicked so far of a polygon that is being drawn.
  constructor(canvas, model, cued) {
    Object.assign(this, { canvas, model, cued, cue: false, held: null, corners: null });
    this.pane = new Pane(canvas, this.data());
    this.fit();
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => this.up(event));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  // What a pane draws.
  data() {
    const { circle, wall, segment, polygon, arc, pocket } = this.model.scene;
    const numbers = (rows, keys) => rows.map((row) => keys.map((key) => value(row[key])));
    return {
      bodies: circle.map((c) => [c.id, value(c.r), c.m === "oo"]),
      walls: numbers(wall, ["x0", "y0", "x1", "y1"]),
      pockets: numbers(pocket, ["x", "y", "r"]),
      segments: numbers(segment, ["x0", "y0", "x1", "y1", "r"]),
      polygons: polygon.map((p) => [outline(p), value(p.r)]),
      arcs: arc.map((a) => Array.from({ length: STEPS + 1 }, (_, k) => onBow(bow(a), k / STEPS))),
      view: this.view ?? [0, 0, 1, 1],
    };
  }

  // The whole scene, with some room: walls count by where they are, not by how far they go.
  whole() {
    const [xs, ys] = [[], []];
    const take = (x, y, r) => { if (Number.isFinite(x + y + r)) { xs.push(x - r, x + r); ys.push(y - r, y + r); } };
    const { circle, wall, segment, polygon, arc, pocket } = this.model.scene;
    for (const a of arc) { const told = bow(a); for (let k = 0; k <= 8; k++) take(...onBow(told, k / 8), 0); }
    for (const p of polygon) for (const [x, y] of outline(p)) take(x, y, value(p.r));
    for (const c of [...circle, ...pocket]) take(value(c.x), value(c.y), value(c.r));
    for (const s of segment) { take(value(s.x0), value(s.y0), value(s.r)); take(value(s.x1), value(s.y1), value(s.r)); }
    for (const w of wall) {
      const [x0, y0, x1, y1] = ["x0", "y0", "x1", "y1"].map((key) => value(w[key]));
      if (x0 === x1) xs.push(x0);
      else if (y0 === y1) ys.push(y0);
      else { take(x0, y0, 0); take(x1, y1, 0); }
    }
    const finite = (list) => (list.some(Number.isFinite) ? list.filter(Number.isFinite) : [-1, 1]);
    const [left, right, bottom, top] = [Math.min(...finite(xs)), Math.max(...finite(xs)), Math.min(...finite(ys)), Math.max(...finite(ys))];
    const room = MARGIN * Math.max(right - left, top - bottom, LEAST) + LEAST;
    return [left - room, bottom - room, right - left + 2 * room, top - bottom + 2 * room];
  }

  fit() {
    this.view = this.whole();
    this.draw();
  }

  get pixel() { return 1 / this.pane.scale; }

  // Where a place on the canvas is in the scene.
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.x, event.clientY - box.y];
    return [(x - this.pane.shift[0]) * this.pixel, (this.pane.shift[1] - y) * this.pixel];
  }

  // The handles of what is chosen: [part, x, y].
  handles() {
    const [thing, kind] = [this.model.thing(), this.model.chosen?.[0]];
    if (!thing) return [];
    if (kind === "wall" || kind === "segment") {
      const ends = [["start", value(thing.x0), value(thing.y0)], ["end", value(thing.x1), value(thing.y1)]];
      if (kind === "segment") return ends;
      const [x, y, vx, vy] = going(thing);
      const rest = vx === 0 && vy === 0 ? ARROW * this.pixel : 0;
      return [...ends, ["throw", x + vx + rest * Math.SQRT1_2, y + vy + rest * Math.SQRT1_2]];
    }
    if (kind === "polygon") return outline(thing).map(([x, y], k) => [k, x, y]);
    const [x, y, r] = [value(thing.x), value(thing.y), value(thing.r)];
    if (kind === "arc" && !thing.full) return [["start", ...onBow(bow(thing), 0)], ["end", ...onBow(bow(thing), 1)], ["size", ...onBow(bow(thing), 1 / 2)]];
    const size = [["size", x + r * Math.SQRT1_2, y - r * Math.SQRT1_2]];
    if (kind === "pocket" || kind === "arc" || thing.m === "oo") return size;
    const [vx, vy] = [value(thing.vx), value(thing.vy)];
    const rest = vx === 0 && vy === 0 ? r + ARROW * this.pixel : 0;
    return [["throw", x + vx + rest * Math.SQRT1_2, y + vy + rest * Math.SQRT1_2], ...size];
  }

  // What is under a place: [chosen, part].
  under(x, y, near) {
    const close = (u, v) => Math.hypot(x - u, y - v) < near;
    for (const [part, u, v] of this.handles()) if (close(u, v)) return [this.model.chosen, part];
    const { circle, wall, segment, polygon, arc, pocket } = this.model.scene;
    const inside = (rows, kind, most) => {
      for (let k = rows.length - 1; k >= 0; k--) {
        const [u, v, r] = [value(rows[k].x), value(rows[k].y), value(rows[k].r)];
        if (Math.hypot(x - u, y - v) < Math.max(r, most)) return [[kind, k], "place"];
      }
      return null;
    };
    const along = (rows, kind, ends) => {
      for (let k = rows.length - 1; k >= 0; k--) {
        const [x0, y0, x1, y1] = ["x0", "y0", "x1", "y1"].map((key) => value(rows[k][key]));
        const [dx, dy] = [x1 - x0, y1 - y0];
        let share = ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy);
        if (ends) share = Math.min(1, Math.max(0, share));
        if (close(x0 + share * dx, y0 + share * dy)) return [[kind, k], "place"];
      }
      return null;
    };
    const within = () => {
      for (let k = polygon.length - 1; k >= 0; k--) if (far(polygon[k], x, y) <= Math.max(value(polygon[k].r), 0)) return [["polygon", k], "place"];
      return null;
    };
    const bent = () => {
      for (let k = arc.length - 1; k >= 0; k--) if (beside(arc[k], x, y) < near) return [["arc", k], "place"];
      return null;
    };
    return inside(circle, "circle", near) ?? along(segment, "segment", true) ?? bent() ?? within() ?? inside(pocket, "pocket", near) ?? along(wall, "wall", false);
  }

  down(event) {
    if (event.button) return;
    const [x, y] = this.at(event);
    const near = (event.pointerType === "touch" ? FINGER : NEAR) * this.pixel;
    if (this.corners) { event.preventDefault(); this.canvas.focus(); this.corner(x, y, near); return; }
    const found = this.under(x, y, near);
    if (!found) { this.model.choose(null); return; }
    event.preventDefault();
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    const [chosen, part] = found;
    this.model.choose(chosen);
    const thing = this.model.thing();
    const cue = this.cue && chosen[0] === "circle" && thing.m !== "oo";
    this.held = { part: cue ? "cue" : part, x, y, moved: false, from: structuredClone(thing) };
    this.pointer = [x, y];
    this.model.keep();
  }

  move(event) {
    if (this.corners) { this.pointer = this.at(event); this.draw(); }
    if (!this.held) return;
    const [x, y] = (this.pointer = this.at(event));
    const { part, from } = this.held;
    const thing = this.model.thing();
    if (!thing) return;
    const put = (values) => { for (const [key, number] of Object.entries(values)) if (Number.isFinite(number)) thing[key] = rounded(number, this.pixel); };
    const [dx, dy] = [x - this.held.x, y - this.held.y];
    this.held.moved ||= Math.hypot(dx, dy) > STILL * this.pixel;
    if (!this.held.moved) return;
    const ends = "x0" in from ? { x0: value(from.x0) + dx, y0: value(from.y0) + dy, x1: value(from.x1) + dx, y1: value(from.y1) + dy } : {};
    if (part === "place" && "x" in from) put({ x: value(from.x) + dx, y: value(from.y) + dy, ...ends });
    else if (part === "place" && "points" in from) this.put(thing, outline(from).map(([u, v]) => [u + dx, v + dy]), from);
    else if (typeof part === "number") this.put(thing, outline(from).map((corner, k) => (k === part ? [x, y] : corner)), from, part);
    else if (part === "place") put(ends);
    else if (part === "start") put({ x0: x, y0: y });
    else if (part === "end") put({ x1: x, y1: y });
    else if (part === "throw") {
      const [u, v] = "x0" in thing ? going(thing) : [value(thing.x), value(thing.y)];
      put({ vx: x - u, vy: y - v });
    }
    else if (part === "size") put({ r: Math.max(Math.hypot(x - value(thing.x), y - value(thing.y)), 2 * this.pixel) });
    else if (part === "cue") put({ vx: value(thing.x) - x, vy: value(thing.y) - y });
    this.model.tell("drag");
  }

  // Puts corners where they are now, those alone that moved: the others stay as exact as they were.
  put(thing, places, from, only = null) {
    if (!places.flat().every(Number.isFinite)) return;
    thing.points = places.map((place, k) => (only === null || only === k ? place.map((number) => rounded(number, this.pixel)) : [...from.points[k]]));
  }

  // A corner of a polygon that is being drawn; the first one once more ends it.
  corner(x, y, near) {
    const [first] = this.corners;
    if (first && this.corners.length > 2 && Math.hypot(x - value(first[0]), y - value(first[1])) < near) { this.finish(); return; }
    const place = [rounded(x, this.pixel), rounded(y, this.pixel)];
    const last = this.corners.at(-1);
    if (this.corners.length < MOST_CORNERS && !(last && last[0] === place[0] && last[1] === place[1])) this.corners.push(place);
    this.model.tell("corner");
  }

  // Begins a polygon; its corners are clicked.
  begin() {
    this.model.choose(null);
    [this.corners, this.pointer] = [[], null];
    this.model.tell("corner");
  }

  // Ends what was begun: with fewer than three corners there is none.
  finish() {
    const points = this.corners;
    this.corners = null;
    if (points?.length > 2) this.model.add("polygon", { points, r: "0" });
    this.model.tell("corner");
  }

  up(event) {
    if (!this.held) return;
    const { moved, part } = this.held;
    this.held = null;
    if (this.canvas.hasPointerCapture(event.pointerId)) this.canvas.releasePointerCapture(event.pointerId);
    if (moved) this.model.tell("change");
    else this.model.forget();
    if (moved && part === "cue") this.cued();
  }

  key(event) {
    const model = this.model;
    if (event.ctrlKey || event.metaKey) {
      if (event.key === "z" && !event.shiftKey) model.undo();
      else if (event.key === "y" || (event.key.toLowerCase() === "z" && event.shiftKey)) model.redo();
      else return;
      event.preventDefault();
      return;
    }
    if (this.corners && (event.key === "Enter" || event.key === "Escape" || event.key === "Backspace")) {
      if (event.key === "Backspace") this.corners.pop();
      else if (event.key === "Escape") this.corners = [];
      if (event.key === "Backspace") model.tell("corner");
      else this.finish();
      event.preventDefault();
      return;
    }
    const turn = { PageDown: 1, PageUp: -1 }[event.key];
    if (turn) {
      const all = model.all();
      const now = all.findIndex(([kind, k]) => kind === model.chosen?.[0] && k === model.chosen?.[1]);
      if (all.length) model.choose(all[(now < 0 ? (turn > 0 ? 0 : all.length - 1) : now + turn + all.length) % all.length]);
      event.preventDefault();
      return;
    }
    const thing = model.thing();
    if (!thing) return;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const step = Math.max(...this.view.slice(2)) / 100;
    const moved = (keys, by) => model.change(() => keys.forEach((key, k) => { thing[key] = rounded(value(thing[key]) + by[k % 2] * step, step / 10); }));
    if (way && event.shiftKey && "vx" in thing && thing.m !== "oo") moved(["vx", "vy"], way);
    else if (way && "points" in thing) model.change(() => this.shift(thing, way[0] * step, way[1] * step, step / 10));
    else if (way) moved(["x", "y", "x0", "y0", "x1", "y1"].filter((key) => key in thing), way);
    else if ((event.key === "+" || event.key === "-") && "r" in thing && "x" in thing) {
      model.change(() => { thing.r = rounded(Math.max(value(thing.r) + (event.key === "+" ? step : -step), step), step / 10); });
    } else if (event.key === "Delete" || event.key === "Backspace") model.remove();
    else if (event.key === "Escape") model.choose(null);
    else return;
    event.preventDefault();
  }

  shift(polygon, dx, dy, pixel) {
    polygon.points = outline(polygon).map(([x, y]) => [rounded(x + dx, pixel), rounded(y + dy, pixel)]);
  }

  draw() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const look = { frame: colour("--frame"), line: colour("--line"), soft: colour("--soft"), text: colour("--text"), colour: colour("--reference"), dash: [], marked: null, ghost: null };
    const { circle, wall } = this.model.scene;
    this.pane.data = this.data();
    const [kind, k] = this.model.chosen ?? [];
    if (kind === "circle") look.marked = { bodies: [k], walls: [] };
    if (kind === "wall") look.marked = { bodies: [], walls: [k] };
    this.pane.fit(this.view);
    this.pane.draw({ at: (body) => [value(circle[body].x), value(circle[body].y)], turn: () => 0 }, 0, look);
    const pen = this.pane.pen;
    pen.lineWidth = 1.6;
    pen.strokeStyle = pen.fillStyle = look.text;
    for (const c of circle) this.arrow(value(c.x), value(c.y), value(c.vx), value(c.vy));
    for (const w of wall) this.arrow(...going(w));
    if (this.held?.part === "cue") this.line(this.pointer[0], this.pointer[1], value(circle[k].x), value(circle[k].y), [8, 4]);
    pen.strokeStyle = pen.fillStyle = look.colour;
    if (this.corners) {
      const places = this.corners.map((corner) => corner.map(value));
      const ways = this.pointer ? [...places, this.pointer] : places;
      ways.slice(1).forEach(([x, y], k) => this.line(...ways[k], x, y, [6, 3]));
      for (const [x, y] of places) { this.pane.round(x, y, 5 * this.pixel); pen.fill(); }
    }
    for (const [part, x, y] of this.handles()) {
      const [px, py] = this.pane.place(x, y);
      pen.beginPath();
      if (part === "size") pen.rect(px - 5, py - 5, 10, 10);
      else pen.arc(px, py, 6, 0, 2 * Math.PI);
      pen.fillStyle = look.frame;
      pen.fill();
      pen.stroke();
    }
  }

  line(x0, y0, x1, y1, dash) {
    const pen = this.pane.pen;
    pen.setLineDash(dash);
    pen.beginPath();
    pen.moveTo(...this.pane.place(x0, y0));
    pen.lineTo(...this.pane.place(x1, y1));
    pen.stroke();
    pen.setLineDash([]);
  }

  arrow(x, y, vx, vy) {
    if (!(Math.hypot(vx, vy) > 0) || !Number.isFinite(x + y + vx + vy)) return;
    this.line(x, y, x + vx, y + vy, []);
    const [px, py] = this.pane.place(x + vx, y + vy);
    const turn = Math.atan2(-vy, vx);
    const pen = this.pane.pen;
    pen.beginPath();
    for (const side of [-2.6, 0, 2.6]) pen.lineTo(px + (side ? 9 * Math.cos(turn + side) : 0), py + (side ? 9 * Math.sin(turn + side) : 0));
    pen.fill();
  }

  // A place where a thing of some size meets nothing, near the middle.
  free(r) {
    const [left, bottom, width, height] = this.view;
    const { circle } = this.model.scene;
    const ring = Math.max(width, height) / 24;
    for (let k = 0; k < 400; k++) {
      const [turn, far] = [k * 2.4, ring * Math.sqrt(k)];
      const [x, y] = [left + width / 2 + far * Math.cos(turn), bottom + height / 2 + far * Math.sin(turn)];
      const apart = circle.every((c) => Math.hypot(x - value(c.x), y - value(c.y)) > r + value(c.r) + 2 * this.pixel);
      const off = this.model.scene.wall.every((w) => away(w, x, y) > r) && this.model.scene.segment.every((s) => away(s, x, y) > r + value(s.r))
        && this.model.scene.polygon.every((p) => far(p, x, y) > r + value(p.r)) && this.model.scene.arc.every((a) => beside(a, x, y) > r);
      if (apart && off) return [rounded(x, this.pixel), rounded(y, this.pixel)];
    }
    return [rounded(left + width / 2, this.pixel), rounded(bottom + height / 2, this.pixel)];
  }

  // What is chosen, in words.
  told() {
    const thing = this.model.thing();
    return thing ? described(this.model.chosen[0], thing) : "";
  }
}

// The middle of the two points of a wall, and its velocity.
function going(wall) {
  const [x0, y0, x1, y1, vx, vy] = ["x0", "y0", "x1", "y1", "vx", "vy"].map((key) => value(wall[key]));
  return [(x0 + x1) / 2, (y0 + y1) / 2, vx, vy];
}

// How far a point is from the line of a wall or a segment.
function away(line, x, y) {
  const [x0, y0, x1, y1] = ["x0", "y0", "x1", "y1"].map((key) => value(line[key]));
  return Math.abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) / Math.hypot(x1 - x0, y1 - y0);
}

// How far a point is from an arc: from its circle where it is within its range, else from the nearer end.
function beside(arc, x, y) {
  const told = bow(arc);
  const [u, v, r, from, way] = told;
  const turn = (((Math.atan2(y - v, x - u) - from) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
  if (turn <= way) return Math.abs(Math.hypot(x - u, y - v) - r);
  return Math.min(...[0, 1].map((share) => { const [ex, ey] = onBow(told, share); return Math.hypot(x - ex, y - ey); }));
}

const outline = (polygon) => polygon.points.map((point) => point.map(value));

// How far a point is from a polygon; 0 inside of it.
function far(polygon, x, y) {
  const points = outline(polygon);
  let [within, least] = [false, Infinity];
  points.forEach(([x1, y1], k) => {
    const [x0, y0] = points.at(k - 1);
    const [dx, dy] = [x1 - x0, y1 - y0];
    if (y0 > y !== y1 > y && x < x0 + ((y - y0) * dx) / dy) within = !within;
    const share = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)));
    least = Math.min(least, Math.hypot(x - x0 - share * dx, y - y0 - share * dy));
  });
  return within ? 0 : least;
}
