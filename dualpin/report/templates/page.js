"use strict";
(() => {
  const all = (s, e = document) => [...e.querySelectorAll(s)];
  all(".js").forEach(e => { e.hidden = false; });

  // light and dark
  const root = document.documentElement;
  document.getElementById("theme").onclick = () => {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  };

  // filters: rows of the matrix and the particulars below it
  all("form.filters").forEach(form => {
    const section = form.closest("section"), items = all("[data-n]", section), count = form.querySelector(".count");
    const apply = () => {
      const text = form.text.value.trim().toLowerCase(), base = form.base.value, status = form.status.value, level = +form.level.value;
      let shown = 0, rows = 0;
      items.forEach(e => {
        const x = +e.dataset.x;
        const on = e.dataset.n.includes(text) && (!base || e.dataset.b === base) && (!status || e.dataset.s === status) && (level >= 1 ? x > 1 : x >= level);
        e.classList.toggle("out", !on);
        if (e.tagName === "TR") { rows += 1; shown += on; }
      });
      count.textContent = `${shown} of ${rows}`;
    };
    form.addEventListener("input", apply);
    form.addEventListener("submit", e => e.preventDefault());
    all(".open-all", section).forEach(b => { b.onclick = () => all("details.robot:not(.out)", section).forEach(d => { d.open = true; }); });
    all(".close-all", section).forEach(b => { b.onclick = () => all("details.robot", section).forEach(d => { d.open = false; }); });
    // a cell leads to its robot
    all(".matrix tbody", section).forEach(body => body.addEventListener("click", e => {
      const cell = e.target.closest("td"), link = cell && cell.parentElement.querySelector("a");
      if (link) { link.click(); }
    }));
  });
  const reveal = () => {
    const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
    if (target && target.tagName === "DETAILS") { target.open = true; target.classList.remove("out"); target.scrollIntoView(); }
  };
  addEventListener("hashchange", reveal);
  document.addEventListener("click", e => {
    const link = e.target.closest("a[href^='#r']");
    if (link && link.hash === location.hash) { reveal(); }
  });
  reveal();

  // sorting
  const value = cell => {
    const text = cell.textContent.replace(/[✗≠,]/g, "").trim(), n = parseFloat(text);
    return text === "–" ? -Infinity : text === "inf" ? Infinity : Number.isNaN(n) || /^[a-z]/i.test(text) ? text.toLowerCase() : n;
  };
  all("table.sortable").forEach(table => all("thead th", table).forEach((th, k) => {
    const button = document.createElement("button");
    button.type = "button"; button.textContent = th.textContent; button.title = "sort";
    th.replaceChildren(button);
    button.onclick = () => {
      const down = th.getAttribute("aria-sort") !== "descending" && k > 0 || th.getAttribute("aria-sort") === "ascending";
      all("thead th", table).forEach(h => h.removeAttribute("aria-sort"));
      th.setAttribute("aria-sort", down ? "descending" : "ascending");
      const body = table.tBodies[0], keyed = [...body.rows].map(r => [value(r.cells[k]), r]);
      const less = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
      keyed.sort((x, y) => (down ? -1 : 1) * less(x[0], y[0]));
      body.append(...keyed.map(x => x[1]));
    };
  }));

  // what a hover says: points of charts, cells with a title
  const tip = document.getElementById("tip");
  const show = (text, x, y) => {
    tip.textContent = text; tip.hidden = false;
    const box = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - box.width - 6))}px`;
    tip.style.top = `${y + 18 + box.height > innerHeight ? y - box.height - 10 : y + 18}px`;
  };
  document.addEventListener("pointerover", e => {
    const cell = e.target.closest("td[title]");
    if (cell) { cell.dataset.t = cell.title; cell.removeAttribute("title"); }
    const spot = e.target.closest("[data-t]");
    if (spot) { show(spot.dataset.t, e.clientX, e.clientY); } else { tip.hidden = true; }
  });
  addEventListener("scroll", () => { tip.hidden = true; }, { passive: true, capture: true });
  addEventListener("keydown", e => { if (e.key === "Escape") { tip.hidden = true; } });

  // lines on and off
  all(".keys button").forEach(b => {
    b.onclick = () => {
      const on = b.getAttribute("aria-pressed") === "false";
      b.setAttribute("aria-pressed", on);
      all(`g[data-s="${b.dataset.s}"]`, b.closest("figure")).forEach(g => g.classList.toggle("out", !on));
    };
  });

  // zoom: drag over a chart, double click to see all of it again
  all("svg.zoom").forEach(svg => {
    const whole = svg.getAttribute("viewBox");
    let start = null;
    const at = e => new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse());
    svg.addEventListener("pointerdown", e => { if (e.pointerType === "mouse") { start = at(e); } });
    svg.addEventListener("pointerup", e => {
      if (!start) { return; }
      const end = at(e), w = Math.abs(end.x - start.x), h = Math.abs(end.y - start.y);
      if (w > 20 && h > 20) { svg.setAttribute("viewBox", `${Math.min(start.x, end.x)} ${Math.min(start.y, end.y)} ${w} ${h}`); }
      start = null;
    });
    svg.addEventListener("dblclick", () => svg.setAttribute("viewBox", whole));
  });

  // copying
  all(".copy").forEach(box => {
    const button = document.createElement("button"), text = box.querySelector("pre, code");
    button.type = "button"; button.textContent = "copy";
    button.onclick = async () => {
      try { await navigator.clipboard.writeText(text.textContent); button.textContent = "copied"; }
      catch { getSelection().selectAllChildren(text); button.textContent = "selected: press Ctrl-C"; }
      setTimeout(() => { button.textContent = "copy"; }, 2000);
    };
    box.prepend(button);
  });
  root.dataset.ready = "yes";
})();
