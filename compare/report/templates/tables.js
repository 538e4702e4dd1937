// Tables that sort by a click on a heading, the button that copies the command, and folds that open on paper.
function amount(text) {
  const plain = text.replaceAll(",", "");
  const found = plain.match(/[-−]?\d+(\.\d+)?(e[-+]?\d+)?/i);
  return found && /^\D{0,12}[-−]?\d/.test(plain) ? Number(found[0].replace("−", "-")) : null;
}

function compareTexts(a, b) {
  const [x, y] = [amount(a), amount(b)];
  if (x !== null && y !== null && x !== y) return x - y;
  return a.localeCompare(b, "en", { numeric: true });
}

for (const table of document.querySelectorAll("table.sortable")) {
  table.querySelectorAll("th").forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const up = heading.getAttribute("aria-sort") !== "ascending";
      for (const other of heading.parentElement.children) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", up ? "ascending" : "descending");
      const body = table.tBodies[0];
      const rows = [...body.rows].sort((one, other) => {
        const order = compareTexts(one.cells[column].textContent, other.cells[column].textContent);
        return up ? order : -order;
      });
      body.append(...rows);
    });
  });
}

for (const button of document.querySelectorAll("[data-copy], [data-copy-text]")) {
  button.hidden = false;
  const source = button.dataset.copy ? document.getElementById(button.dataset.copy) : button.previousElementSibling;
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(source.textContent);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(source);
      button.textContent = "Selected: press Ctrl+C";
    }
  });
}

// Folds of one name are open one at a time, as a page on a telephone would grow long; a wide one shows as many as are
// wanted, and an engine that is unfolded with all of its parts. Paper shows everything.
const narrow = matchMedia("(max-width: 42rem)");
const folds = [...document.querySelectorAll("details:not(.help)")].map((fold) => [fold, fold.getAttribute("name")]);
let printed = null; // while it is printed: whether each fold was open
function grouped() {
  for (const [fold, name] of folds) {
    if (narrow.matches && !printed) fold.setAttribute("name", name);
    else fold.removeAttribute("name");
    if (!narrow.matches && fold.classList.contains("part")) fold.open = true;
  }
}
addEventListener("beforeprint", () => {
  printed ??= folds.map(([fold]) => fold.open);
  grouped();
  for (const [fold] of folds) fold.open = true;
});
addEventListener("afterprint", () => {
  folds.forEach(([fold], place) => { fold.open = printed[place]; });
  printed = null;
  grouped();
});
narrow.addEventListener("change", grouped);
grouped();

// What closes above a fold that is opened moves it: it stays in sight.
for (const [fold] of folds) {
  const summary = fold.querySelector("summary");
  summary.addEventListener("click", () => setTimeout(() => {
    const { top } = summary.getBoundingClientRect();
    if (fold.open && (top < 0 || top > innerHeight)) summary.scrollIntoView({ block: "start" });
  }));
}

// A link to what is folded opens it; of the marks "?" one is open at a time, and Escape or a click elsewhere closes it.
const unfold = () => {
  const to = location.hash && document.getElementById(location.hash.slice(1));
  for (let fold = to && to.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  if (to) to.scrollIntoView();
};
addEventListener("hashchange", unfold);
unfold();
const marks = [...document.querySelectorAll("details.help")];
addEventListener("click", (event) => { for (const mark of marks) if (!mark.contains(event.target)) mark.open = false; });
addEventListener("keydown", (event) => { if (event.key === "Escape") for (const mark of marks) mark.open = false; });
