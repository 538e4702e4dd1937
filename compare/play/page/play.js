// The page: what is pressed, what is asked of the engines, and what is shown of their answers.
import { fragment, packed, unpacked } from "./address.js";
import { Editor } from "./editor.js";
import { LESSONS } from "./lessons.js";
import { KINDS, MOST_CORNERS, Model, checked, described, plain, rounded, value } from "./scene.js";
import { InBrowser, Server } from "./transport.js";

const START = JSON.parse(document.getElementById("start").textContent);
const $ = (id) => document.getElementById(id);
const OWN = {
  name: "mine",
  circle: [
    { id: "a", x: "-5", y: "0", r: "1", vx: "2", vy: "0.3", m: "1" },
    { id: "b", x: "3", y: "0.5", r: "1", vx: "0", vy: "0", m: "1" },
    { id: "c", x: "0", y: "-3", r: "sqrt(2)/2", vx: "1", vy: "1", m: "1/2" },
  ],
  wall: [
    { id: "left", x0: "-9", y0: "0", x1: "-9", y1: "1" },
    { id: "right", x0: "9", y0: "0", x1: "9", y1: "1" },
    { id: "bottom", x0: "0", y0: "-5", x1: "1", y1: "-5" },
    { id: "top", x0: "0", y0: "5", x1: "1", y1: "5" },
  ],
};
const model = new Model(checked(START.scene ?? OWN));
const editor = new Editor($("editor"), model, () => { setCue(false); run({}); });
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const hash = fragment();
const engines = START.transport === "server" ? new Server(hash.get("token")) : new InBrowser(loading);
const state = { ready: false, busy: false, ran: null, player: null, shell: null, written: "" };

function say(place, words) {
  place.textContent = words;
  place.hidden = !words && place.id !== "ready" && place.id !== "progress";
}

function made(tag, values = {}, ...children) {
  const element = Object.assign(document.createElement(tag), values);
  element.append(...children);
  return element;
}

// -- The scene: list, fields, undo, address.

function refresh() {
  editor.draw();
  $("undo").disabled = !model.before.length;
  $("redo").disabled = !model.after.length;
  $("remove").disabled = !model.chosen;
  if (document.activeElement !== $("restitution")) $("restitution").value = model.scene.restitution ?? "1";
  for (const [way, name] of ["gravity-x", "gravity-y"].entries()) if (document.activeElement !== $(name)) $(name).value = model.scene.gravity?.[way] ?? "0";
  list();
  fields();
}

function list() {
  const rows = model.all().map(([kind, k]) => {
    const chosen = kind === model.chosen?.[0] && k === model.chosen?.[1];
    const button = made("button", { type: "button", textContent: described(kind, model.scene[kind][k]) });
    button.setAttribute("aria-pressed", String(chosen));
    button.addEventListener("click", () => { model.choose([kind, k]); $("things").querySelector("[aria-pressed=true]")?.focus(); });
    return made("li", {}, button);
  });
  $("things").replaceChildren(...rows);
}

function fields() {
  const [thing, kind] = [model.thing(), model.chosen?.[0]];
  $("numbers").hidden = !thing;
  if (!thing) return;
  const name = `${KINDS[kind].name} ${thing.id}`;
  const shown = `${kind} ${thing.id} ${thing.points?.length ?? ""}`;
  $("corners").hidden = kind !== "polygon";
  $("fewer").disabled = !(thing.points?.length > 3);
  $("more").disabled = !(thing.points?.length < MOST_CORNERS);
  if ($("numbers").dataset.of !== shown) {
    $("numbers").dataset.of = shown;
    $("numbers-title").textContent = name;
    $("fields").replaceChildren(...keysOf(thing, kind).map((key) => {
      const input = made("input", { type: "text", name: key, autocomplete: "off", spellcheck: false, maxLength: 400 });
      input.setAttribute("aria-label", `${key} of ${name}`);
      return made("label", {}, made("span", { textContent: WORDS[key] ?? key }), input);
    }));
  }
  for (const input of $("fields").querySelectorAll("input")) if (document.activeElement !== input) input.value = part(thing, input.name);
}

// The numbers of a thing by name: each corner's two, where it has corners.
const keysOf = (thing, kind) => KINDS[kind].keys.filter((key) => key in thing).flatMap((key) => (key === "points" ? thing.points.flatMap((_, k) => [`x${k + 1}`, `y${k + 1}`]) : [key]));
const corner = (thing, name) => (thing.points && /^[xy]\d+$/.test(name) ? [thing.points[name.slice(1) - 1], name[0] === "x" ? 0 : 1] : [thing, name]);
const part = (thing, name) => { const [of, key] = corner(thing, name); return of[key]; };

const WORDS = { r: "radius", m: "mass (oo: fixed)", vx: "velocity x", vy: "velocity y" };

$("fields").addEventListener("change", (event) => {
  const [key, typed, thing] = [event.target.name, event.target.value.trim(), model.thing()];
  if (!thing || !typed || part(thing, key) === typed) return;
  model.change(() => { const [of, name] = corner(thing, key); of[name] = typed; if (key === "m" && typed === "oo") thing.vx = thing.vy = "0"; });
});
// One corner more halves the longest side; one less leaves out the last.
$("more").addEventListener("click", () => model.change(() => {
  const { points } = model.thing();
  const places = points.map((point) => point.map(value));
  const long = places.map(([x, y], k) => Math.hypot(x - places.at(k - 1)[0], y - places.at(k - 1)[1]));
  const k = long.indexOf(Math.max(...long));
  const middle = [0, 1].map((way) => rounded((places[k][way] + places.at(k - 1)[way]) / 2, editor.pixel / 10));
  points.splice(k, 0, middle);
}));
$("fewer").addEventListener("click", () => model.change(() => model.thing().points.pop()));
$("restitution").addEventListener("change", (event) => {
  const typed = event.target.value.trim() || "1";
  model.change((scene) => { scene.restitution = typed; });
});
for (const [way, name] of ["gravity-x", "gravity-y"].entries()) {
  $(name).addEventListener("change", (event) => {
    const typed = event.target.value.trim() || "0";
    model.change((scene) => { scene.gravity = (scene.gravity ?? ["0", "0"]).with(way, typed); });
  });
}
$("numbers").addEventListener("submit", (event) => event.preventDefault());

model.addEventListener("told", ({ detail }) => {
  if (detail === "drag") { editor.draw(); fields(); return; }
  if (detail === "corner") { drawing(); editor.draw(); return; }
  if (detail === "scene") editor.fit();
  refresh();
  if (detail === "choice") say($("edited"), editor.told());
  else {
    say($("edited"), editor.told());
    write();
  }
});

let writing = 0;
// The address follows the scene; a name of the catalogue is short, and says what it is.
async function write() {
  const turn = ++writing;
  const told = await packed(plainWhole());
  if (turn !== writing) return;
  state.written = `#s=${told}`;
  history.replaceState(null, "", state.written);
}

function plainWhole() {
  return { ...model.scene, events: wanted() };
}

function wanted() {
  const typed = Number($("events").value);
  return Number.isInteger(typed) && typed > 0 ? Math.min(typed, START.mostEvents) : 300;
}

$("events").addEventListener("change", () => { $("events").value = wanted(); write(); });

const RADIUS = () => Math.max(...editor.view.slice(2)) / 20;
function addCircle(fixed) {
  const r = rounded(RADIUS(), editor.pixel);
  const [x, y] = editor.free(Number(r));
  model.add("circle", { x, y, r, vx: "0", vy: "0", m: fixed ? "oo" : "1" });
}
$("add-circle").addEventListener("click", () => addCircle(false));
$("add-post").addEventListener("click", () => addCircle(true));
$("add-pocket").addEventListener("click", () => {
  const [x, y] = editor.free(RADIUS());
  model.add("pocket", { x, y, r: rounded(RADIUS(), editor.pixel) });
});
for (const kind of ["wall", "segment"]) {
  $(`add-${kind}`).addEventListener("click", () => {
    const [left, bottom, width, height] = editor.view;
    const at = (share, from, size) => rounded(from + share * size, editor.pixel);
    const y = kind === "wall" ? at(0.04, bottom, height) : editor.free(RADIUS())[1];
    model.add(kind, { x0: at(0.4, left, width), y0: y, x1: at(0.6, left, width), y1: y, ...(kind === "segment" ? { r: "0" } : { vx: "0", vy: "0" }) });
  });
}
// Open below, with its ends beside each other; or all round what is there.
$("add-arc").addEventListener("click", () => {
  const r = rounded(2 * RADIUS(), editor.pixel);
  const [x, y] = editor.free(Number(r));
  const ends = { x0: rounded(value(x) + value(r), editor.pixel), y0: y, x1: rounded(value(x) - value(r), editor.pixel), y1: y };
  model.add("arc", { x, y, r, ...ends });
});
$("add-ring").addEventListener("click", () => {
  const [left, bottom, width, height] = editor.view;
  const [x, y] = [left + width / 2, bottom + height / 2].map((number) => rounded(number, editor.pixel));
  model.add("arc", { x, y, r: rounded(Math.hypot(width, height) / 2, editor.pixel), full: true });
  editor.fit();
});
$("add-polygon").addEventListener("click", () => {
  const { corners } = editor;
  if (!corners) { editor.begin(); return; }
  if (!corners.length) editor.corners = triangle();
  editor.finish();
});
// What one gets by pressing twice: three corners in a free place.
function triangle() {
  const r = RADIUS();
  const [x, y] = editor.free(2 * r).map(Number);
  return [[x - r, y - r], [x + r, y - r], [x, y + r]].map((point) => point.map((number) => rounded(number, editor.pixel)));
}
function drawing() {
  const { corners } = editor;
  $("add-polygon").setAttribute("aria-pressed", String(Boolean(corners)));
  $("add-polygon").textContent = !corners ? "+ polygon" : corners.length > 2 ? "Close the polygon" : corners.length ? "Give it up" : "Place a triangle";
  const begun = () => (corners.length ? `a polygon with ${corners.length} corner${corners.length > 1 ? "s" : ""} so far` : "Click the corners one after the other; the first once more, or Enter, closes it.");
  say($("edited"), corners ? begun() : editor.told());
}
$("remove").addEventListener("click", () => { model.remove(); $("editor").focus(); });
$("undo").addEventListener("click", () => model.undo());
$("redo").addEventListener("click", () => model.redo());
$("fit").addEventListener("click", () => editor.fit());
function setCue(on) {
  editor.cue = on;
  $("cue").setAttribute("aria-pressed", String(on));
}
$("cue").addEventListener("click", () => setCue(!editor.cue));

// -- Scenes to pick from, and lessons.

const catalogue = fetch("scenes.json").then((answer) => answer.json()).catch(() => []);
const drawn = (row) => { try { return checked(row.scene); } catch { return null; } };
catalogue.then((all) => {
  const rows = all.filter(drawn);
  $("pictures").replaceChildren(...rows.map((row) => {
    const image = made("img", { alt: "", width: 160, loading: "lazy", src: `data:image/svg+xml,${encodeURIComponent(row.picture)}` });
    const button = made("button", { type: "button", title: row.about }, image, made("span", { textContent: row.name }));
    button.addEventListener("click", () => { take(row); $("catalogue").open = false; $("editor").focus(); });
    return made("li", {}, button);
  }));
});

function take(row) {
  const scene = checked(row.scene);
  $("events").value = Math.min(scene.events ?? 300, 300);
  model.replace(scene);
  say($("edited"), `scene ${row.name}: ${row.about}`);
}

async function lesson(name) {
  const { title, scene, events, question, steps, seen } = LESSONS[name];
  const row = (await catalogue).find((each) => each.name === scene);
  if (row) take(row);
  $("events").value = events;
  $("lesson").hidden = false;
  $("lesson-title").textContent = title;
  $("lesson-question").textContent = question;
  $("lesson-steps").replaceChildren(...steps.map((step) => made("li", { textContent: step })));
  $("lesson-seen").replaceChildren(made("details", {}, made("summary", { textContent: "What one sees" }), made("p", { textContent: seen })));
  ++writing;
  history.replaceState(null, "", `#lesson=${name}`);
}
$("lessons").replaceChildren(...Object.entries(LESSONS).map(([name, { title }]) => {
  const button = made("button", { type: "button", textContent: title });
  button.addEventListener("click", () => lesson(name));
  return button;
}));

// -- Runs.

function loading({ words, share }) {
  $("loading").hidden = false;
  if (share !== undefined) $("loading").value = share;
  say($("ready"), words);
}

function buttons() {
  for (const id of ["go", "ulp", "turn"]) $(id).disabled = !state.ready || state.busy;
  for (const id of ["why", "prove", "report"]) $(id).disabled = !state.ready || state.busy;
  $("stop").disabled = !state.busy;
}

// Asks for something that takes a while; null where it was refused or stopped, which is then said.
async function asked(message, words) {
  if (!state.ready || state.busy) return null;
  state.busy = true;
  buttons();
  say($("progress"), words);
  let count = "";
  const last = await engines.ask(message, (told) => { count = `${told.events.toLocaleString("en")} events`; say($("progress"), `${words}: ${told.note ? `${told.note}, ` : ""}${count}`); });
  state.busy = false;
  buttons();
  if (last.kind === "refused" || last.kind === "stopped") {
    say($("progress"), last.kind === "stopped" && count ? `Stopped after ${count}.` : sentence(last.error));
    return null;
  }
  say($("progress"), "");
  return last;
}

const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`;

function message(kind, more = {}) {
  const seconds = Math.min(60, Math.max(1, Number($("seconds").value) || 10));
  return { kind, scene: plain(model.scene), events: wanted(), seconds, engines: [$("with").value], ...more };
}

async function run(more) {
  const asking = message("run", more);
  const last = await asked(asking, "Running");
  if (!last) return;
  state.ran = { asking, last, scene: JSON.stringify(asking.scene) };
  if (last.recording) await show(last.recording);
  else say($("progress"), "All of it happens at time 0: there is nothing to play.");
  tell(last);
  if (last.recording) $("run-title").scrollIntoView({ block: "start", behavior: calm.matches ? "auto" : "smooth" });
}

function tell(last) {
  const verdict = $("verdict");
  verdict.className = `verdict ${last.tone}`;
  say(verdict, last.verdict);
  const proved = last.exact.proved ? "every decision proved" : "not every decision proved";
  const cut = last.cut.length ? ` Left out, as the seconds were over: ${last.cut.join(", ")}.` : "";
  say($("exactness"), `Exact: ${last.exact.events.toLocaleString("en")} event${last.exact.events === 1 ? "" : "s"}, ${proved}; ${last.exact.stop}. All of it took ${last.seconds.toFixed(2)} s.${cut}`);
  say($("home"), last.turned ? home(last) : "");
  $("after").hidden = false;
  $("checked").hidden = true;
  say($("proof"), "");
  answers(last.why);
}

// How far from its start each run is at the end; and why the exact one may be far, too.
function home(last) {
  const far = (miss) => (miss === null ? "does not get home" : `is ${distance(miss)} from home`);
  const runs = [["the exact run", last.home], ...last.others.map((other) => [other.name, other.home])].map(([name, miss]) => `${name} ${far(miss)}`);
  const { ties } = last.exact;
  const why = last.home && ties ? ` At ${ties.toLocaleString("en")} instant${ties > 1 ? "s" : ""} discs touch several things at once: what those do is a choice of model, which turning round need not undo.` : "";
  return `Turned back half-way: ${runs.join("; ")}.${why}`;
}

const script = (src) => new Promise((done) => document.body.append(made("script", { src, onload: done })));

const distance = (x) => (x === 0 ? "exactly 0" : x.toPrecision(3));

function answers(why) {
  $("answers").hidden = !why;
  if (!why) return;
  const rows = [["Where", why.where], ["Why", why.why], ["So what", why.so_what], ["What now", why.what_now]];
  $("answers").replaceChildren(...rows.map(([name, words]) => {
    const told = made("dd", { textContent: words });
    if (name === "What now") told.append(made("span", { className: "go" }, made("code", { textContent: why.command })));
    return made("div", {}, made("dt", { textContent: name }), told);
  }));
}

// Hands a recording to the report's player, which is loaded with the first and given each other one.
async function show(recording) {
  const first = !state.player;
  if (first) {
    document.body.append(made("script", { type: "application/json", id: "recording", textContent: JSON.stringify(recording) }));
    state.player = script("player.js").then(() => script("replay.js"));
  }
  await state.player;
  if (!first) replay.take(recording);
  replay.begin();
}

$("go").addEventListener("click", () => run({}));
$("ulp").addEventListener("click", () => run({ ulp: true, engines: ["double"] }));
$("turn").addEventListener("click", () => run({ back: Math.max(1, Math.floor(wanted() / 2)) }));
$("stop").addEventListener("click", () => engines.stop());
async function explain() {
  const last = await asked({ ...state.ran.asking, why: true }, "Looking for causes");
  if (!last) return;
  state.ran.last = last;
  tell(last);
  $("answers").querySelector("dd")?.scrollIntoView({ block: "nearest" });
}
$("why").addEventListener("click", explain);

// -- Things to take away.

async function copy(words, what) {
  $("copied-text").hidden = false;
  $("copied-text").textContent = words;
  const done = await navigator.clipboard?.writeText(words).then(() => true, () => false);
  say($("copied"), done ? `${what} copied.` : `${what} is below, to be copied by hand.`);
}

$("copy-link").addEventListener("click", async () => {
  const link = `${location.origin}${location.pathname}#s=${await packed(plainWhole())}`;
  copy(link, "The link");
});
for (const [id, key, what] of [["copy-toml", "toml", "The scene as TOML"], ["copy-python", "python", "The scene as Python"], ["copy-command", "command", "The command"]]) {
  $(id).addEventListener("click", async () => {
    const last = await asked(message("texts"), "Writing");
    if (last) copy(last[key], what);
  });
}

function save(name, text, kind) {
  const link = made("a", { href: URL.createObjectURL(new Blob([text], { type: kind })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const stem = () => model.scene.name.replace(/[^A-Za-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 60) || "scene";

$("prove").addEventListener("click", async () => {
  const { scene, events, seconds } = state.ran.asking;
  const last = await asked({ kind: "certificate", scene, events, seconds }, "Writing the certificate");
  if (!last) return;
  save(`${stem()}-certificate.json`, last.text, "application/json");
  say($("proof"), "The certificate is saved; it is checked now, by a program that shares nothing with the engine.");
  $("checked").hidden = true;
  const checker = new Worker("check.js", { type: "module" });
  checker.onmessage = ({ data }) => {
    say($("proof"), `Certificate of ${last.events.toLocaleString("en")} events, saved and checked in this page: ${data}.`);
    if (data.startsWith("verified")) whatWasChecked(JSON.parse(last.text));
    checker.terminate();
  };
  checker.onerror = () => { say($("proof"), "The certificate is saved; the checker did not load: run truebreak verify FILE."); };
  checker.postMessage(last.text);
});

// What verify.mjs has shown of a certificate that it verified, with how many there were of each.
function whatWasChecked({ instants, end }) {
  const count = (part) => instants.reduce((sum, instant) => sum + part(instant), 0);
  const many = (n, one, more = `${one}s`) => `${n.toLocaleString("en")} ${n === 1 ? one : more}`;
  const pushes = count(({ rounds = [] }) => rounds.flat().length);
  const met = count(({ met = [] }) => met.length);
  const witnesses = count(({ zeros = [] }) => zeros.length) + (end.zeros?.length ?? 0);
  const ends = { quiet: "nothing meets ever again", horizon: "nothing more meets until the time stated", return: "the run is back at its start", events: "the run goes to the last event asked for" };
  const rows = [
    ["Meetings", `${many(met, "contact")} in ${many(instants.length, "instant")}: each has gap zero at its time, within the decimals stated.`],
    ["Between", "On every flight from one instant to the next no disc meets anything else."],
    ["Pushes", `${many(pushes, "push", "pushes")}: each is the law's, of what approaches then, by the tie policy; after the last none approaches.`],
    ["Exactly zero", witnesses ? `${many(witnesses, "number")} said to be exactly zero: each shown so by its witness, an isometry or exact arithmetic; none is assumed.` : "No number needed a witness."],
    ["The end", sentence(ends[end.reason] ?? end.reason)],
  ];
  $("checked").replaceChildren(...rows.map(([name, words]) => made("div", {}, made("dt", { textContent: name }), made("dd", { textContent: words }))));
  $("checked").hidden = false;
}

const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");
$("report").addEventListener("click", async () => {
  if (!state.ran.last.why) await explain();
  state.shell ??= await fetch("shell.html").then((answer) => answer.text());
  const { last, asking } = state.ran;
  const why = last.why ?? {};
  const parts = {
    TITLE: escaped(`${asking.scene.name}: did floating point change what happened?`), TONE: last.tone, VERDICT: escaped(last.verdict),
    WHERE: escaped(why.where ?? "–"), WHY: escaped(why.why ?? "–"), SO: escaped(why.so_what ?? "–"), NOW: escaped(why.what_now ?? "–"),
    COMMAND: escaped(why.command ?? ""), SCENE: escaped(JSON.stringify(asking.scene, null, 1)),
    DAY: new Date().toISOString().slice(0, 10),
    RECORDING: JSON.stringify(last.recording).replaceAll("<", "\\u003c"),
  };
  save(`${stem()}.html`, state.shell.replace(/@@([A-Z]+)@@/g, (whole, name) => parts[name] ?? whole), "text/html");
});

// -- The start.

async function fromAddress() {
  try {
    if (hash.has("s")) {
      const scene = await unpacked(hash.get("s"));
      if (scene.events) $("events").value = Math.min(scene.events, START.mostEvents);
      model.scene = scene;
      model.tell("scene");
    } else if (hash.has("scene")) {
      const row = (await catalogue).find((each) => each.name === hash.get("scene"));
      if (row) take(row);
      else say($("edited"), "The address names a scene that the page does not have.");
    } else if (Object.hasOwn(LESSONS, hash.get("lesson") ?? "")) await lesson(hash.get("lesson"));
    else if (hash.has("token")) await write();
  } catch (error) {
    say($("edited"), `The address holds no scene that can be played: ${error.message}.`);
  }
}

// The player's mark "?" closes by Escape, and by a click elsewhere, as in a report.
const shut = (event) => { for (const mark of document.querySelectorAll("details.help[open]")) if (event.key === "Escape" || (event.type === "click" && !mark.contains(event.target))) mark.open = false; };
for (const kind of ["click", "keydown"]) addEventListener(kind, shut);

const resized = () => editor.draw();
new ResizeObserver(resized).observe($("editor").parentElement);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", resized);
addEventListener("hashchange", () => { if (location.hash !== state.written) location.reload(); });
refresh();
await fromAddress();
const told = await engines.ready();
$("loading").hidden = true;
if (told.kind === "refused") say($("ready"), sentence(told.error));
else {
  $("with").replaceChildren(...told.engines.map((name) => new Option(name)));
  state.ready = true;
  say($("ready"), "Ready.");
}
buttons();
if (START.transport === "worker" && "serviceWorker" in navigator) navigator.serviceWorker.register("offline.js").catch(() => {});
