"use strict";
(function () {
  const form = document.querySelector("form.filters"), table = document.querySelector("table");
  if (!table) return;
  const body = table.tBodies[0], rows = Array.from(body.rows), selects = Array.from(form.querySelectorAll("select"));
  const words = document.getElementById("words"), shown = document.getElementById("shown");
  function filter() {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      const fits = wanted.every((word) => text.includes(word))
        && selects.every((one) => !one.value || row.dataset[one.dataset.key] === one.value);
      row.hidden = !fits;
      count += fits ? 1 : 0;
    }
    shown.textContent = count === rows.length ? `${count} run${count === 1 ? "" : "s"}` : `${count} of ${rows.length} runs`;
  }
  function sort(head) {
    const at = head.cellIndex, number = head.dataset.sort === "number";
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const key = (row) => row.cells[at].dataset.value || "";
    rows.sort((a, b) => {
      const x = key(a), y = key(b);
      if (!x || !y) return x ? -1 : y ? 1 : 0;
      const order = number ? Number(x) - Number(y) : x.localeCompare(y);
      return down ? -order : order;
    });
    for (const row of rows) body.append(row);
  }
  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", filter);
  for (const head of table.tHead.rows[0].cells) {
    if (!head.dataset.sort) continue;
    head.tabIndex = 0;
    head.addEventListener("click", () => sort(head));
    head.addEventListener("keydown", (event) => { if (event.key === "Enter") sort(head); });
  }
})();
