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

for (const button of document.querySelectorAll("[data-copy]")) {
  button.hidden = false;
  const source = document.getElementById(button.dataset.copy);
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
  for (const fold of document.querySelectorAll("details.outcome")) fold.open = true;
});
