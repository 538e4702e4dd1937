// The player: one clock for the reference and one engine.
const player = document.getElementById("player");
const data = JSON.parse(document.getElementById("recording").textContent);
const part = (name) => document.getElementById(name);
const motions = data.runs.map((run) => new Motion(run, data.bodies, data.gravity));
const panes = { truth: new Pane(part("pane-truth"), data), engine: new Pane(part("pane-engine"), data) };
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const ONE_INSTANT = 1e-9; // share of the time by which two events may lie apart and still be shown as one instant
const SECONDS = 30; // a whole run at speed 1
const alone = data.runs.length === 1;
const SMALL = 9; // radius in pixels below which the bodies of the divergence are shown close up at first
// `picked`: of several stops at one time, the one that was meant.
const state = { time: data.begin, playing: false, chosen: alone ? 0 : 1, last: 0, sound: null, close: false, picked: -1 };
let [rows, stops] = [[], []]; // the list, and the instants in it: [time, row]

const sides = alone ? ["truth"] : ["truth", "engine"];
const candidate = () => data.runs[state.chosen];
const divergence = () => candidate().divergence;
const goal = () => divergence()?.time ?? candidate().stopped ?? null;
const shown = (time) => Number(time.toPrecision(9)).toString();

function pairs(event) {
  return event[2].map((pair) => pair.join("–")).join(" ");
}

// When an event is, as far as that tells it from the one before.
function when(events, k) {
  const [time, before] = [shown(events[k][1]), k ? shown(events[k - 1][1]) : ""];
  if (time !== before) return `t = ${time}`;
  const later = events[k][3] ?? (events[k][1] > events[k - 1][1] ? (events[k][1] - events[k - 1][1]).toPrecision(3) : "");
  return later ? `${later} later` : `t = ${time}`;
}

// Both lists of events, row by row: each of the reference with the engine's that it is, those of the engine alone between.
function aligned() {
  const [mine, theirs] = [motions[0].run.events, alone ? [] : candidate().events];
  const left = divergence();
  const places = new Map(theirs.map((event, k) => [event[0], k]));
  const alike = (k) => theirs[k] && (!left || mine[k][0] < left.expected) && pairs(theirs[k]) === pairs(mine[k]);
  const twin = (k) => candidate().matches ? places.get(candidate().matches[k]) : left?.expected === mine[k][0] ? places.get(left.got) : alike(k) ? k : undefined;
  const taken = new Set();
  const found = mine.map((event, k) => {
    const other = alone ? undefined : twin(k);
    const own = taken.has(other) ? undefined : other;
    taken.add(own);
    return { truth: k, own, time: event[1], first: left?.expected === event[0] };
  });
  theirs.forEach((event, k) => { if (!taken.has(k)) found.push({ own: k, time: event[1], first: Boolean(left) && left.expected === null && left.got === event[0] }); });
  return found.sort((one, other) => one.time - other.time);
}

// The instants of the list in order, each with its row; the two of a row that are one but for rounding, once.
function instants() {
  const found = [];
  rows.forEach((row, k) => {
    const times = [row.truth === undefined ? null : motions[0].run.events[row.truth][1], row.own === undefined ? null : candidate().events[row.own][1]].filter((t) => t !== null);
    if (times.length === 2 && near(...times)) times.pop();
    for (const time of times) found.push([time, k]);
  });
  return found.sort((one, other) => one[0] - other[0] || one[1] - other[1]);
}

function look(element, dashed) {
  const style = getComputedStyle(element);
  const colour = (name) => style.getPropertyValue(name).trim();
  const near = divergence() && state.time >= divergence().time - 0.02 * (data.end - data.begin);
  return {
    frame: colour("--frame"), line: colour("--line"), soft: colour("--soft"), text: colour("--text"),
    reference: colour("--reference"), colour: dashed ? colour("--engine") : colour("--reference"),
    dash: dashed ? colour("--dash").split(" ").map(Number) : [], marked: near ? divergence() : null,
    ghost: dashed ? motions[0] : null,
  };
}

function draw() {
  panes.truth.draw(motions[0], state.time, look(player, false));
  if (!alone) panes.engine.draw(motions[state.chosen], state.time, look(part("engine-figure"), true));
  drawStrip();
}

// The error at a time, between samples by its logarithm, or by the larger of two if one is zero; null beyond them.
function errorAt(time) {
  const rows = candidate().errors ?? [];
  const k = lastNotAfter(rows, time, (row) => row[0]);
  if (k < 0 || rows[k][1] === null) return null;
  if (k === rows.length - 1 || rows[k + 1][1] === null || time === rows[k][0]) return rows[k][1];
  if (!rows[k][1] || !rows[k + 1][1]) return Math.max(rows[k][1], rows[k + 1][1]);
  const share = (time - rows[k][0]) / (rows[k + 1][0] - rows[k][0]);
  return rows[k][1] * (rows[k + 1][1] / rows[k][1]) ** share;
}

// Past the divergence places are those of another history: no digits of this one are left.
function parted(time) {
  return Boolean(divergence()) && time > divergence().time && !near(time, divergence().time);
}

function digitsLeft(time) {
  if (parted(time)) return 0;
  const error = errorAt(time);
  return error === null ? null : error === 0 ? Infinity : Math.max(0, -Math.log10(error / candidate().scale));
}

function show() {
  const scrubber = part("scrubber");
  scrubber.value = state.time;
  scrubber.setAttribute("aria-valuetext", `time ${shown(state.time)}`);
  part("clock").textContent = shown(state.time);
  const digits = digitsLeft(state.time);
  part("digits").textContent = parted(state.time) ? "none: another history" : digits === null ? "–" : digits === Infinity ? "all" : digits.toFixed(1);
  part("digit-bar").firstElementChild.style.width = `${Math.min(100, (100 * (digits ?? 0)) / 16)}%`;
  follow();
  for (const plot of document.querySelectorAll("#errors svg")) moveCursor(plot);
  draw();
  if (data.embedded) parent.postMessage({ truebreakTime: state.time }, "*");
}

// Whether two times are one instant but for rounding.
function near(one, other) {
  return Math.abs(one - other) <= ONE_INSTANT * Math.abs(other);
}

// The place among the stops: the one that was picked, if it is of this time, else the last by now; -1 before the first.
function placeNow() {
  if (state.picked >= 0 && near(stops[state.picked][0], state.time)) return state.picked;
  return lastNotAfter(stops, state.time, (stop) => stop[0]);
}

function follow() {
  const [list, place] = [part("list"), placeNow()];
  const now = place < 0 ? null : list.children[stops[place][1]];
  const before = list.querySelector("[aria-selected=true]");
  if (before === now) return;
  before?.setAttribute("aria-selected", "false");
  if (!now) { list.removeAttribute("aria-activedescendant"); list.scrollTop = 0; return; }
  now.setAttribute("aria-selected", "true");
  list.setAttribute("aria-activedescendant", now.id);
  reveal();
}

function reveal() {
  const list = part("list");
  const now = list.querySelector("[aria-selected=true]");
  if (now) list.scrollTop = now.offsetTop - list.clientHeight / 2;
}

function named(row) {
  return row.truth === undefined ? `an event of ${candidate().name} alone` : `event ${motions[0].run.events[row.truth][0]}`;
}

// Says where the clock stands, for the eye and for a screen reader; not while it runs.
function tell() {
  const place = placeNow();
  const row = place < 0 ? null : rows[stops[place][1]];
  const cells = row ? [[motions[0], row.truth], ...(alone ? [] : [[motions[state.chosen], row.own]])] : [];
  const what = cells.map(([motion, k]) => `${motion.run.name} ${k === undefined ? "has none" : pairs(motion.run.events[k])}`).join(", ");
  const ends = sides.map((side) => motionOf(side)).filter((motion) => state.time > motion.run.end || (candidate().stopped === state.time && motion !== motions[0]));
  const ended = ends.map((motion) => `; the run of ${motion.run.name} ends at t = ${shown(motion.run.end)}: ${motion.run.stop}`).join("");
  const first = row?.first && stops[place][0] && near(state.time, stops[place][0]) ? ". The first divergence." : "";
  part("told").textContent = `t = ${shown(state.time)}; ${row ? `${named(row)}: ${what}` : "nothing yet"}${ended}${first}`;
}

function motionOf(side) {
  return side === "truth" ? motions[0] : motions[state.chosen];
}

function seek(time, silent = false, picked = -1) {
  state.time = Math.min(Math.max(time, data.begin), data.end);
  state.picked = picked;
  show();
  if (!silent) tell();
}

function stop() {
  state.playing = false;
  part("play").textContent = "Play";
  part("play").setAttribute("aria-pressed", "false");
  tell();
}

function play() {
  if (calm.matches) return;
  if (state.time >= data.end) state.time = data.begin;
  state.playing = true;
  state.last = performance.now();
  part("play").textContent = "Stop";
  part("play").setAttribute("aria-pressed", "true");
  requestAnimationFrame(tick);
}

function tick(now) {
  if (!state.playing) return;
  const before = state.time;
  const speed = (Number(part("speed").value) * (data.end - data.begin)) / SECONDS;
  const after = before + (speed * Math.max(0, now - state.last)) / 1000;
  state.last = now;
  seek(after, true);
  if (state.sound) {
    if (motions[0].eventAt(after) > motions[0].eventAt(before)) click(-1);
    if (!alone && motions[state.chosen].eventAt(after) > motions[state.chosen].eventAt(before)) click(1);
  }
  if (state.time >= data.end) stop();
  else requestAnimationFrame(tick);
}

// A click in one ear: -1 left, 1 right.
function click(ear) {
  const [context, from] = [state.sound, state.sound.currentTime];
  const [tone, loudness, pan] = [context.createOscillator(), context.createGain(), context.createStereoPanner()];
  tone.frequency.value = 1200;
  pan.pan.value = ear;
  loudness.gain.setValueAtTime(0.2, from);
  loudness.gain.exponentialRampToValueAtTime(0.001, from + 0.04);
  tone.connect(loudness).connect(pan).connect(context.destination);
  tone.start(from);
  tone.stop(from + 0.05);
}

// To the event after or before; of several at one instant, one after the other.
function step(way) {
  if (state.playing) stop();
  const place = placeNow();
  const here = place >= 0 && near(stops[place][0], state.time);
  const next = way > 0 || here ? place + way : place;
  if (next < 0 || next >= stops.length) return seek(way > 0 ? data.end : data.begin);
  return seek(stops[next][0], false, next);
}

// To the first divergence, or to where a run stopped that does not tell.
function jump() {
  if (state.playing) stop();
  const row = rows.findIndex((each) => each.first);
  seek(goal(), false, stops.findIndex(([time, k]) => k === row && near(time, goal())));
}

function fill() {
  [rows, state.picked] = [aligned(), -1];
  stops = instants();
  part("list-title-truth").textContent = motions[0].run.name;
  part("list-title-engine").textContent = alone ? "" : candidate().name;
  part("list").replaceChildren(...rows.map((row, k) => {
    const line = document.createElement("li");
    line.id = `row-${k}`;
    line.setAttribute("role", "option");
    line.setAttribute("aria-selected", "false");
    const cell = (motion, place) => (place === undefined ? "–" : `${pairs(motion.run.events[place])}  ${when(motion.run.events, place)}`);
    const texts = [row.truth === undefined ? "" : String(motions[0].run.events[row.truth][0]), cell(motions[0], row.truth)];
    if (!alone) texts.push(cell(motions[state.chosen], row.own));
    if (row.first) texts[0] += " ◆";
    line.className = `${row.first ? "first" : ""}${!alone && (row.own === undefined || row.truth === undefined) ? " odd" : ""}`;
    line.append(...texts.map((text) => Object.assign(document.createElement("span"), { textContent: text })));
    line.addEventListener("click", () => { if (state.playing) stop(); const to = stops.findIndex((each) => each[1] === k); seek(stops[to][0], false, to); });
    return line;
  }));
}

const STRIP = 56; // pixels of the strip's height
const FLOOR = 2 ** -53; // of the scale: below it doubles tell nothing

// The strip of time: the error on a logarithmic scale, ticks of both runs, the predicted band, the divergence, the clock.
function drawStrip() {
  const [canvas, ratio] = [part("strip"), devicePixelRatio || 1];
  const [width, run] = [canvas.clientWidth, candidate()];
  if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = STRIP * ratio; }
  const pen = canvas.getContext("2d");
  const colours = look(alone ? player : part("engine-figure"), !alone);
  const x = (time) => (width * (time - data.begin)) / (data.end - data.begin);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = colours.frame;
  pen.fillRect(0, 0, width, STRIP);
  if (run.predicted) { pen.globalAlpha = 0.16; pen.fillStyle = colours.colour; pen.fillRect(x(run.predicted[0]), 0, Math.max(2, x(run.predicted[1]) - x(run.predicted[0])), STRIP); pen.globalAlpha = 1; }
  const ticks = (motion, from, to, colour) => { pen.strokeStyle = colour; pen.lineWidth = 1; pen.globalAlpha = 0.6; pen.beginPath(); for (const t of motion.eventTimes) { pen.moveTo(x(t), from); pen.lineTo(x(t), to); } pen.stroke(); pen.globalAlpha = 1; };
  ticks(motions[0], STRIP - 7, STRIP, colours.reference);
  if (!alone) ticks(motions[state.chosen], 0, 7, colours.colour);
  const errors = (run.errors ?? []).filter((row) => row[1] !== null);
  if (errors.length) {
    const [low, high] = [Math.log10(run.scale * FLOOR), Math.log10(Math.max(run.scale, ...errors.map((row) => row[1])))];
    pen.strokeStyle = colours.colour;
    pen.lineWidth = 1.6;
    pen.beginPath();
    errors.forEach(([t, e], k) => pen[k ? "lineTo" : "moveTo"](x(t), 10 + (STRIP - 20) * (1 - Math.max(0, (Math.log10(e || 1e-300) - low) / (high - low)))));
    pen.stroke();
  }
  const left = divergence();
  if (left) { pen.fillStyle = colours.text; pen.font = "13px system-ui, sans-serif"; pen.textAlign = "center"; pen.textBaseline = "middle"; pen.fillText("◆", Math.min(width - 7, Math.max(7, x(left.time))), STRIP / 2); }
  pen.strokeStyle = colours.text;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x(state.time), 0);
  pen.lineTo(x(state.time), STRIP);
  pen.stroke();
}

function choose(number) {
  state.chosen = number;
  const run = candidate();
  if (!alone) part("engine-figure").className = `e${run.number}`;
  part("name-truth").textContent = data.runs[0].title;
  part("name-engine").textContent = run.title;
  part("digits-told").hidden = part("digit-bar").hidden = !run.errors;
  part("jump").hidden = goal() === null;
  part("jump").textContent = run.divergence ? "To the first divergence" : "To where it stopped";
  const [whole, from] = [data.total, data.runs[0].events];
  const cut = from.length < whole && from.length ? `Shown are events ${from[0][0].toLocaleString("en")} to ${from.at(-1)[0].toLocaleString("en")} of the ${whole.toLocaleString("en")} of ${data.runs[0].name}. ` : "";
  part("window").textContent = cut;
  fill();
  const close = closeView();
  part("close").hidden = !close;
  zoom(Boolean(close) && Math.max(...run.divergence.bodies.map((body) => data.bodies[body][1])) * panes.truth.scale < SMALL);
  show();
  tell();
}

function closeView() {
  const left = divergence();
  return left && closeUp(data, [motions[0], motions[state.chosen]], left.bodies, left.time);
}

// Shows the bodies of the divergence alone, or all.
function zoom(close) {
  state.close = close;
  part("close").setAttribute("aria-pressed", String(close));
  fitAll();
}

function moveCursor(plot) {
  const [left, right, end] = ["left", "right", "end"].map((name) => Number(plot.dataset[name]));
  const x = left + ((right - left) * Math.min(state.time, end)) / end;
  const line = plot.querySelector(".cursor");
  line.setAttribute("x1", x);
  line.setAttribute("x2", x);
}

for (const plot of document.querySelectorAll("#errors svg")) {
  const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
  line.setAttribute("class", "cursor");
  line.setAttribute("y1", plot.dataset.top);
  line.setAttribute("y2", plot.dataset.bottom);
  plot.append(line);
  plot.addEventListener("click", (event) => {
    const box = plot.getBoundingClientRect();
    const x = ((event.clientX - box.x) * plot.viewBox.baseVal.width) / box.width;
    const [left, right, end] = ["left", "right", "end"].map((name) => Number(plot.dataset[name]));
    seek((end * (x - left)) / (right - left));
  });
}

const KEYS = {
  " ": () => (state.playing ? stop() : play()),
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
  Home: () => seek(data.begin),
  End: () => seek(data.end),
};

// Keys are the player's where it has the focus, and where nothing has it while its panes are in sight.
function meant(event) {
  const box = part("pane-truth").getBoundingClientRect();
  return player.contains(event.target) || (event.target === document.body && box.bottom > 0 && box.top < innerHeight);
}

document.addEventListener("keydown", (event) => {
  const list = event.target.closest("[role=listbox]");
  const own = ["SELECT", "SUMMARY"].includes(event.target.tagName) || (event.target.tagName === "BUTTON" && event.key === " ");
  const way = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  const act = list && way ? () => step(way) : KEYS[event.key];
  if (!act || own || !meant(event) || event.altKey || event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  act();
});

Object.assign(part("scrubber"), { min: data.begin, max: data.end });
part("scrubber").addEventListener("input", (event) => { if (state.playing) stop(); seek(Number(event.target.value)); });
part("strip").addEventListener("click", (event) => {
  if (state.playing) stop();
  const box = part("strip").getBoundingClientRect();
  seek(data.begin + ((data.end - data.begin) * (event.clientX - box.x)) / box.width);
});
part("play").addEventListener("click", () => (state.playing ? stop() : play()));
part("back").addEventListener("click", () => step(-1));
part("forth").addEventListener("click", () => step(1));
part("jump").addEventListener("click", jump);
part("close").addEventListener("click", () => { zoom(!state.close); draw(); });
part("sound").addEventListener("click", (event) => {
  state.sound = state.sound ? (state.sound.close(), null) : new AudioContext();
  event.currentTarget.setAttribute("aria-pressed", String(Boolean(state.sound)));
});
player.classList.toggle("alone", alone);
part("engine-figure").hidden = alone;
part("engine").replaceChildren(...data.runs.slice(1).map((run, k) => new Option([run.name, run.verdict].filter(Boolean).join(": "), k + 1)));
part("engine").addEventListener("change", (event) => choose(Number(event.target.value)));
part("choice").hidden = data.runs.length < 3;

function quiet() {
  part("play").hidden = part("sound").hidden = calm.matches;
  part("still").hidden = !calm.matches;
  if (calm.matches && state.playing) stop();
}

function resize() {
  fitAll();
  reveal(); // a page that is laid out late, as in a notebook, had nothing to scroll before
  draw();
}

function fitAll() {
  const view = (state.close && closeView()) || data.view;
  panes.truth.fit(view);
  if (!alone) panes.engine.fit(view);
}

player.hidden = false;
fitAll();
calm.addEventListener("change", quiet);
quiet();
choose(alone ? 0 : data.lead);
part("engine").value = String(state.chosen);
if (goal() !== null) jump();
new ResizeObserver(resize).observe(part("pane-truth").parentElement);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
if (data.embedded) addEventListener("message", (event) => {
  const time = event.data?.truebreakTime;
  if (event.source !== parent || typeof time !== "number") return;
  if (state.playing) stop();
  seek(time);
});
