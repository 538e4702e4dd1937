// The player: one clock for the reference and one engine.
const player = document.getElementById("player");
const data = JSON.parse(document.getElementById("recording").textContent);
const part = (name) => document.getElementById(name);
const motions = data.runs.map((run) => new Motion(run, data.bodies));
const panes = { truth: new Pane(part("pane-truth"), data), engine: new Pane(part("pane-engine"), data) };
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const ONE_INSTANT = 1e-9; // share of the time by which two events may lie apart and still be shown as one instant
const SECONDS = 30; // a whole run at speed 1
const alone = data.runs.length === 1;
const SMALL = 9; // radius in pixels below which the bodies of the divergence are shown close up at first
// `picked`: of several events at one time, the one that was meant, on each side.
const state = { time: data.begin, playing: false, chosen: alone ? 0 : 1, last: 0, sound: null, close: false, picked: {} };

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

function digitsLeft(time) {
  const error = errorAt(time);
  return error === null ? null : error === 0 ? Infinity : Math.max(0, -Math.log10(error / candidate().scale));
}

function show() {
  const scrubber = part("scrubber");
  scrubber.value = state.time;
  scrubber.setAttribute("aria-valuetext", `time ${shown(state.time)}`);
  part("clock").textContent = shown(state.time);
  const digits = digitsLeft(state.time);
  part("digits").textContent = digits === null ? "–" : digits === Infinity ? "all" : digits.toFixed(1);
  part("digit-bar").firstElementChild.style.width = `${Math.min(100, (100 * (digits ?? 0)) / 16)}%`;
  for (const side of sides) follow(side);
  for (const plot of document.querySelectorAll("#errors svg")) moveCursor(plot);
  draw();
  if (data.embedded) parent.postMessage({ truebreakTime: state.time }, "*");
}

function motionOf(side) {
  return side === "truth" ? motions[0] : motions[state.chosen];
}

// The place in a side's list: of the event that was picked, if it is of this time but for rounding, else of the last
// one by now.
function placeOf(side) {
  const [motion, picked] = [motionOf(side), state.picked[side]];
  return near(motion.eventTimes[picked], state.time) ? picked : motion.eventAt(state.time);
}

// Whether two times are one instant but for rounding.
function near(one, other) {
  return Math.abs(one - other) <= ONE_INSTANT * Math.abs(other);
}

function follow(side) {
  const list = part(`list-${side}`);
  const place = placeOf(side);
  const now = list.children[place];
  const before = list.querySelector("[aria-selected=true]");
  if (before === (now ?? null)) return;
  before?.setAttribute("aria-selected", "false");
  if (!now) { list.removeAttribute("aria-activedescendant"); list.scrollTop = 0; return; }
  now.setAttribute("aria-selected", "true");
  list.setAttribute("aria-activedescendant", now.id);
  reveal(side);
}

function reveal(side) {
  const list = part(`list-${side}`);
  const now = list.querySelector("[aria-selected=true]");
  if (now) list.scrollTop = now.offsetTop - list.clientHeight / 2;
}

// Says where the clock stands, for the eye and for a screen reader; not while it runs.
function tell() {
  const told = sides.map((side) => {
    const motion = motionOf(side);
    const event = motion.run.events[placeOf(side)];
    const ended = state.time > motion.run.end || candidate().stopped === state.time && side === "engine" ? ` (its run ends at t = ${shown(motion.run.end)}: ${motion.run.stop})` : "";
    return `${motion.run.name}: ${event ? `event ${event[0]}, ${pairs(event)}` : "nothing yet"}${ended}`;
  });
  const left = divergence();
  const first = left && Math.abs(left.time - state.time) <= 1e-12 * Math.abs(left.time) ? ". The first divergence." : "";
  part("told").textContent = `t = ${shown(state.time)}; ${told.join("; ")}${first}`;
}

function seek(time, silent = false, picked = {}) {
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

// To the event after or before, on any of the sides given; of several at one instant, one after the other.
function step(way, among = sides) {
  if (state.playing) stop();
  const [places, picked] = [Object.fromEntries(sides.map((side) => [side, placeOf(side)])), {}];
  for (const side of among) {
    const other = places[side] + way;
    if (places[side] >= 0 && near(motionOf(side).eventTimes[other], state.time)) picked[side] = other;
  }
  if (Object.keys(picked).length) return seek(state.time, false, { ...places, ...picked });
  const times = among.flatMap((side) => motionOf(side).eventTimes);
  const ahead = times.filter((t) => !near(t, state.time) && (way > 0 ? t > state.time : t < state.time));
  if (!ahead.length) return seek(way > 0 ? data.end : data.begin);
  const time = way > 0 ? Math.min(...ahead) : Math.max(...ahead);
  const first = way > 0 ? Object.fromEntries(sides.map((side) => [side, motionOf(side).eventTimes.findIndex((t) => near(t, time))])) : {};
  return seek(time, false, first);
}

// To the first divergence, or to where a run stopped that does not tell.
function jump() {
  if (state.playing) stop();
  const left = divergence();
  const place = (side, index) => motionOf(side).run.events.findIndex((event) => event[0] === index);
  seek(goal(), false, left ? { truth: place("truth", left.expected), engine: place("engine", left.got) } : {});
}

function fill(side) {
  const [list, motion] = [part(`list-${side}`), motionOf(side)];
  const left = divergence();
  const first = left && (side === "truth" ? left.expected : left.got);
  part(`list-title-${side}`).textContent = `${motion.run.name}: events`;
  list.replaceChildren(...motion.run.events.map((event, k) => {
    const row = document.createElement("li");
    row.id = `${side}-${k}`;
    row.setAttribute("role", "option");
    row.setAttribute("aria-selected", "false");
    row.textContent = `${event[0]}  ${when(motion.run.events, k)}  ${pairs(event)}`;
    if (left && event[0] === first) { row.className = "first"; row.textContent += "  ◆ first divergence"; }
    row.addEventListener("click", () => { if (state.playing) stop(); seek(event[1], false, { ...state.picked, [side]: k }); });
    return row;
  }));
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
  const grows = run.growth > 0 ? `A small error grows by ${run.growth.toPrecision(3)} bits an event: it uses up the 53 bits of a double in about ${Math.round(53 / run.growth)} events.` : "";
  part("growth").textContent = cut + grows;
  sides.forEach(fill);
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
  const own = event.target.tagName === "SELECT" || (event.target.tagName === "BUTTON" && event.key === " ");
  const way = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  const act = list && way ? () => step(way, [list.id.slice(5)]) : KEYS[event.key];
  if (!act || own || !meant(event) || event.altKey || event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  act();
});

Object.assign(part("scrubber"), { min: data.begin, max: data.end });
part("scrubber").addEventListener("input", (event) => { if (state.playing) stop(); seek(Number(event.target.value)); });
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
part("engine-figure").hidden = part("engine-events").hidden = alone;
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
  sides.forEach(reveal); // a page that is laid out late, as in a notebook, had nothing to scroll before
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
