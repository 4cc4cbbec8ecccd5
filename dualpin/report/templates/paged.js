"use strict";
// the table of many robots: a hundred rows at a time
document.querySelectorAll("form.paged").forEach(form => {
  const PAGE = 100, section = form.closest("section");
  const rows = JSON.parse(section.querySelector("script.rows").textContent), body = section.querySelector("table.pages tbody");
  const names = rows.map(r => r[0].toLowerCase());
  let found = rows.map((_, k) => k), first = 0;
  const cell = (text, kind, tag = "td") => {
    const e = document.createElement(tag);
    e.className = kind; e.textContent = text;
    return e;
  };
  const draw = () => {
    body.replaceChildren(...found.slice(first, first + PAGE).map(k => {
      const [label, base, nv, mark, , , link, ...cells] = rows[k], row = document.createElement("tr");
      const head = cell(label, "name", "th");
      if (link) { const a = cell(label, "", "a"); a.href = `#${link}`; head.replaceChildren(a); }
      if (mark !== "✓") { head.append(" ", cell(mark, mark === "✗" ? "no" : "dim", "b")); }
      row.append(head, cell(base, "text"), cell(nv, ""), ...cells.map(c => {
        const [kind, text] = c.split(" ");
        return cell((kind === "bad" ? "✗ " : kind === "other" ? "≠ " : "") + text, kind);
      }));
      return row;
    }));
    const last = Math.min(first + PAGE, found.length);
    form.querySelector(".count").textContent = found.length ? `${first + 1} to ${last} of ${found.length}` : "none";
    form.back.disabled = first === 0; form.on.disabled = last === found.length;
  };
  const filter = () => {
    const text = form.text.value.trim().toLowerCase(), base = form.base.value, status = form.status.value;
    found = rows.map((_, k) => k).filter(k => names[k].includes(text) && (!base || rows[k][1] === base) && (!status || rows[k][4] === status));
    if (form.order.value) { found.sort((i, k) => rows[k][5] - rows[i][5]); }
    first = 0; draw();
  };
  form.addEventListener("input", filter);
  form.addEventListener("submit", e => e.preventDefault());
  form.back.onclick = () => { first = Math.max(0, first - PAGE); draw(); };
  form.on.onclick = () => { first += PAGE; draw(); };
  draw();
});
