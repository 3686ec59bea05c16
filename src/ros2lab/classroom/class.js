// Sorts the table by a column, and shows only the rows that hold what was typed. Without it the table is whole.
const table = document.getElementById("students");
const body = table.tBodies[0];
const filter = document.getElementById("filter");
const count = document.getElementById("count");
document.getElementById("controls").hidden = false;

function showMatching() {
  const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
  let shown = 0;
  for (const row of body.rows) {
    const text = row.textContent.toLowerCase();
    row.hidden = !words.every((word) => text.includes(word));
    shown += row.hidden ? 0 : 1;
  }
  count.textContent = `${shown} of ${body.rows.length} shown`;
}

function sortBy(header, column) {
  const isUp = header.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", isUp ? "ascending" : "descending");
  const collator = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });
  const compare = (a, b) => ("value" in a.dataset ? a.dataset.value - b.dataset.value : collator.compare(a.textContent, b.textContent));
  const rows = [...body.rows].sort((a, b) => compare(a.cells[column], b.cells[column]) * (isUp ? 1 : -1));
  body.append(...rows);
}

[...table.tHead.rows[0].cells].forEach((header, column) => {
  const button = document.createElement("button");
  button.type = "button";
  button.append(...header.childNodes);
  button.addEventListener("click", () => sortBy(header, column));
  header.append(button);
});
filter.addEventListener("input", showMatching);
showMatching();
