"use strict";
// A field above each long table: of its rows those remain that have all the words; a remark stays with one of its rows.
for (const table of document.querySelectorAll("table")) {
  const rows = [...table.tBodies[0].rows];
  if (rows.length < 20) continue;
  const field = Object.assign(document.createElement("input"), { type: "search", placeholder: "words of a row" });
  const label = Object.assign(document.createElement("label"), { className: "filter", textContent: "Filter " });
  const count = document.createElement("output");
  label.append(field, count);
  table.parentElement.before(label);
  field.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let remark = null;
    let shown = 0;
    for (const row of rows) {
      if (row.querySelector(".remark")) {
        remark = row;
        remark.hidden = words.length > 0;
        continue;
      }
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
      if (row.hidden) continue;
      shown += 1;
      if (remark) remark.hidden = false;
    }
    count.textContent = ` ${shown} rows`;
  });
}
