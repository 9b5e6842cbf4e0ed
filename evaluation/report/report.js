"use strict";
// Sorting by a click on a heading, and filtering by words; without this script the report is only less convenient.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  table.tHead.addEventListener("click", (event) => {
    const heading = event.target.closest("th");
    if (!heading) return;
    const ascending = heading.getAttribute("aria-sort") !== "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", ascending ? "ascending" : "descending");
    const value = (row) => row.cells[heading.cellIndex].textContent;
    const collate = new Intl.Collator("en", { numeric: true }).compare; // to which 0.9 is less than 0.25
    const number = (text) => Number.parseFloat(text.replaceAll(",", ""));
    const compare = (a, b) => number(a) - number(b) || collate(a, b);
    const rows = [...body.rows].sort((a, b) => compare(value(a), value(b)));
    body.append(...(ascending ? rows : rows.reverse()));
  });
}
for (const input of document.querySelectorAll("input[data-filters]")) {
  const selector = input.dataset.filters;
  input.addEventListener("input", () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const item of document.querySelectorAll(selector)) {
      const text = item.textContent.toLowerCase();
      item.hidden = !words.every((word) => text.includes(word));
    }
  });
}
