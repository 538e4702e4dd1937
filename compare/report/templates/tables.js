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

addEventListener("beforeprint", () => {
  for (const fold of document.querySelectorAll("details:not(.help)")) fold.open = true;
});

// A link to what is folded opens it; of the marks "?" one is open at a time, and Escape or a click elsewhere closes it.
const unfold = () => { const to = location.hash && document.getElementById(location.hash.slice(1)); if (to?.tagName === "DETAILS") to.open = true; };
addEventListener("hashchange", unfold);
unfold();
const marks = [...document.querySelectorAll("details.help")];
for (const mark of marks) mark.addEventListener("toggle", () => { if (mark.open) for (const other of marks) if (other !== mark) other.open = false; });
addEventListener("click", (event) => { for (const mark of marks) if (!mark.contains(event.target)) mark.open = false; });
addEventListener("keydown", (event) => { if (event.key === "Escape") for (const mark of marks) mark.open = false; });
