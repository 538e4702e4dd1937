const {rows, engines, words, labels, changed} = JSON.parse(document.getElementById("data").textContent);
const scenes = new Map();
rows.forEach((row, number) => {
  row.number = number;
  if (!scenes.has(row.scene)) scenes.set(row.scene, {});
  scenes.get(row.scene)[row.engine] = row;
});
const [text, engine, state, count] = ["text", "engine", "state", "count"].map(id => document.getElementById(id));
const body = document.querySelector("#grid tbody");
const marks = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"};
const safe = value => String(value).replace(/[&<>"]/g, mark => marks[mark]);
const kind = row => row.mark || row.verdict;
const place = row => !row ? -1 : row.event ?? (row.agreed ?? 0) + 0.5;
let order = {engine: null, down: false};

function cell(row) {
  if (!row) return "<td></td>";
  const where = row.event == null ? "" : ` at event ${row.event}`;
  const law = row.laws && row.laws.kept === false ? "; law not kept" : "";
  const shown = (words[kind(row)] || kind(row)) + where + law;
  const report = row.link ? `<a class="report" href="${safe(row.link)}">report</a>` : "";
  return `<td class="${safe(kind(row))}"><button data-row="${row.number}">${safe(shown)}</button>${report}</td>`;
}

function since(of) {
  const told = engines.map(engine => of[engine] && of[engine].since).filter(sentence => sentence);
  return changed ? `<td>${told.map(safe).join("<br>")}</td>` : "";
}

function draw() {
  const wanted = text.value.toLowerCase(), only = state.value, shown = engine.value ? [engine.value] : engines;
  const fits = row => row && (!only || (only === "changed" ? row.since : kind(row) === only));
  const names = [...scenes.keys()].filter(
    name => name.toLowerCase().includes(wanted) && shown.some(engine => fits(scenes.get(name)[engine])));
  if (order.engine !== null) {
    const key = order.engine === "" ? name => name : name => place(scenes.get(name)[order.engine]);
    const sign = order.down ? -1 : 1;
    names.sort((a, b) => sign * (key(a) > key(b) ? 1 : key(a) < key(b) ? -1 : 0));
  }
  for (const head of document.querySelectorAll("#grid [data-of]")) head.hidden = !shown.includes(head.dataset.of);
  body.innerHTML = names.map(name => {
    const of = scenes.get(name);
    return `<tr><th scope="row">${safe(name)}</th>${shown.map(engine => cell(of[engine])).join("")}${since(of)}</tr>`;
  }).join("");
  count.textContent = `${names.length} of ${scenes.size} scenes`;
}

for (const control of [text, engine, state]) control.addEventListener("input", draw);
for (const button of document.querySelectorAll("#grid thead button")) button.addEventListener("click", () => {
  order = {engine: button.dataset.engine, down: order.engine === button.dataset.engine && !order.down};
  for (const head of document.querySelectorAll("#grid thead th")) head.removeAttribute("aria-sort");
  button.closest("th").setAttribute("aria-sort", order.down ? "descending" : "ascending");
  draw();
});
body.addEventListener("click", event => {
  const button = event.target.closest("button");
  if (!button) return;
  const row = rows[button.dataset.row];
  const plain = value => value === true ? "yes" : value === false ? "no" : value === null ? "not known"
    : Array.isArray(value) ? value.join(", ") || "none"
    : typeof value === "object" ? Object.entries(value).map(([key, one]) => `${labels[key] || key}: ${plain(one)}`).join("; ") : value;
  const shown = Object.entries(row).filter(([key]) => !["number", "link", "command"].includes(key));
  document.getElementById("row").innerHTML = shown.map(([key, value]) =>
    `<dt>${safe(labels[key] || key.replaceAll("_", " "))}</dt><dd>${safe(plain(value))}</dd>`).join("")
    + (row.link ? `<dt>report</dt><dd><a href="${safe(row.link)}">${safe(row.link)}</a></dd>` : "")
    + (row.command ? `<dt>report</dt><dd><code>${safe(row.command)}</code></dd>` : "");
  document.querySelector("dialog").showModal();
});
draw();
