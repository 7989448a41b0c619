/* SPDX-License-Identifier: Apache-2.0 */
/* Tables sort by a click or a key on a column's head; what is folded opens for print. */
"use strict";

function valueOf(row, column) {
  const cell = row.cells[column];
  if (!cell || cell.textContent === "") return null;
  return cell.dataset.value === undefined ? cell.textContent : Number(cell.dataset.value);
}

/* Numbers before texts, what is empty last whichever way. */
function compare(a, b, sign) {
  if (a === null || b === null) return (a === null) - (b === null);
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return sign * (typeof a === "number" ? a - b : a.localeCompare(b, "en", { numeric: true }));
}

function sortBy(head) {
  const table = head.closest("table"), body = table.tBodies[0];
  const down = head.getAttribute("aria-sort") === "ascending";
  const rows = Array.from(body.rows, (row) => ({ row, value: valueOf(row, head.cellIndex) }));
  rows.sort((a, b) => compare(a.value, b.value, down ? -1 : 1));
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  body.append(...rows.map((entry) => entry.row));
  document.getElementById("said").textContent =
    `Sorted by ${head.textContent}, ${down ? "largest" : "smallest"} first`;
}

for (const button of document.querySelectorAll("th > button"))
  button.addEventListener("click", () => sortBy(button.parentElement));

const contents = document.querySelector("nav details");
const wide = window.matchMedia("(min-width: 68rem)");
function fold() {
  contents.open = wide.matches;
}
wide.addEventListener("change", fold);
fold();

const links = new Map();
for (const link of document.querySelectorAll("nav a")) links.set(link.hash.slice(1), link);
const watcher = new IntersectionObserver(
  (entries) => {
    for (const entry of entries)
      if (entry.isIntersecting) {
        for (const link of links.values()) link.removeAttribute("aria-current");
        links.get(entry.target.id).setAttribute("aria-current", "true");
      }
  },
  { rootMargin: "-10% 0px -80% 0px" },
);
for (const section of document.querySelectorAll("main > section")) watcher.observe(section);

window.addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
});
