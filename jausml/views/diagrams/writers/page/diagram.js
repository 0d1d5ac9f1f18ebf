"use strict";
// The page of one diagram: zoom, pan, filter, tables, details. Texts of the model are set as text
// alone.
(() => {
  const svg = document.querySelector("main > svg");
  const known = JSON.parse(document.getElementById("known").textContent);
  const filter = document.getElementById("filter");
  const details = document.getElementById("details");
  const list = document.getElementById("list");
  const whole = svg.getAttribute("viewBox").split(" ").map(Number);
  const drawn = [...svg.querySelectorAll("[data-key]")];
  const lines = [...list.querySelectorAll("tbody tr")];
  // Labels share the keys of their edges, which come first.
  const order = [...new Set(drawn.map((each) => each.dataset.key))];
  let view = [...whole];
  let kept = new Set(order);
  let chosen = "";

  function show() {
    svg.setAttribute("viewBox", view.join(" "));
  }

  function zoom(factor, x, y) {
    const wanted = Math.min(Math.max(view[2] * factor, whole[2] / 40), whole[2] * 2);
    const real = wanted / view[2];
    view = [x - (x - view[0]) * real, y - (y - view[1]) * real, wanted, view[3] * real];
    show();
  }

  function place(x, y) {
    return new DOMPoint(x, y).matrixTransform(svg.getScreenCTM().inverse());
  }

  function middle() {
    return [view[0] + view[2] / 2, view[1] + view[3] / 2];
  }

  function fit() {
    view = [...whole];
    show();
  }

  function matching() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const matches = (key) => words.every((word) => known[key].text.toLowerCase().includes(word));
    return order.filter(matches);
  }

  function apply() {
    const found = matching();
    kept = new Set(found);
    for (const key of found) for (const end of known[key].ends) kept.add(end);
    for (const each of drawn) each.classList.toggle("faded", !kept.has(each.dataset.key));
    const own = new Set(found);
    for (const each of lines) each.hidden = !own.has(each.dataset.key);
  }

  function line(tag, text, kind) {
    const made = document.createElement(tag);
    made.textContent = text;
    if (kind) made.className = kind;
    details.append(made);
  }

  function tell(key) {
    chosen = known[key] ? key : "";
    details.replaceChildren();
    for (const each of [...drawn, ...lines]) {
      each.classList.toggle("chosen", each.dataset.key === chosen);
    }
    details.hidden = !chosen;
    if (!chosen) return;
    const found = known[key];
    line("h2", found.title);
    for (const [kind, text] of found.findings) line("p", `${kind}: ${text}`, kind);
    for (const [name, text] of found.details) {
      line("h3", name);
      line("p", text);
    }
  }

  // Moves the picture where what is chosen lies outside of it.
  function reveal() {
    const part = drawn.find((each) => each.dataset.key === chosen);
    if (!part || !list.hidden) return;
    const inside = svg.getBoundingClientRect();
    const box = part.getBoundingClientRect();
    const [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
    if (x > inside.left && x < inside.right && y > inside.top && y < inside.bottom) return;
    const at = place(x, y);
    view = [at.x - view[2] / 2, at.y - view[3] / 2, view[2], view[3]];
    show();
  }

  function choose(key) {
    if (!key) return;
    tell(key);
    reveal();
  }

  function step(by) {
    const among = order.filter((key) => kept.has(key));
    const at = among.indexOf(chosen);
    const next = at < 0 ? (by > 0 ? 0 : among.length - 1) : at + by;
    choose(among[(next + among.length) % among.length]);
  }

  // Out: from a box or row to the edge that leaves it, from an edge to its target. In: back.
  function follow(near, far) {
    if (!chosen) return;
    if (known[chosen][far]) choose(known[chosen][far][0]);
    else choose(order.find((key) => known[key][near] && known[key][near].includes(chosen)));
  }

  function sort(head) {
    const table = head.closest("table");
    const heads = [...table.querySelectorAll("th")];
    const column = heads.indexOf(head);
    const falls = head.getAttribute("aria-sort") === "ascending";
    for (const each of heads) each.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", falls ? "descending" : "ascending");
    const text = (row) => row.cells[column].textContent;
    const rows = [...table.tBodies[0].rows].sort((one, other) =>
      text(one).localeCompare(text(other), "en", { numeric: true }));
    table.tBodies[0].append(...(falls ? rows.reverse() : rows));
  }

  function toggle() {
    list.hidden = !list.hidden;
    // The picture is no HTML element, and has no property `hidden`.
    svg.toggleAttribute("hidden", !list.hidden);
    document.getElementById("tables").setAttribute("aria-pressed", String(!list.hidden));
  }

  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    const at = place(event.clientX, event.clientY);
    zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, at.x, at.y);
  }, { passive: false });

  let held = null;
  let moved = false;
  svg.addEventListener("pointerdown", (event) => {
    held = place(event.clientX, event.clientY);
    moved = false;
  });
  svg.addEventListener("pointermove", (event) => {
    if (!held || !event.buttons) return;
    const at = place(event.clientX, event.clientY);
    moved = moved || Math.hypot(at.x - held.x, at.y - held.y) > view[2] / 300;
    view[0] += held.x - at.x;
    view[1] += held.y - at.y;
    show();
  });
  svg.addEventListener("pointerup", (event) => {
    held = null;
    if (moved) return;
    const part = event.target.closest("[data-key]");
    tell(part ? part.dataset.key : "");
  });
  list.addEventListener("click", (event) => {
    const head = event.target.closest("th");
    const row = event.target.closest("tr[data-key]");
    if (head) sort(head);
    else if (row) tell(row.dataset.key);
  });

  filter.addEventListener("input", apply);
  document.getElementById("fit").addEventListener("click", fit);
  document.getElementById("tables").addEventListener("click", toggle);
  document.getElementById("closer").addEventListener("click", () => zoom(1 / 1.4, ...middle()));
  document.getElementById("further").addEventListener("click", () => zoom(1.4, ...middle()));

  const pans = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const keys = {
    "+": () => zoom(1 / 1.4, ...middle()),
    "-": () => zoom(1.4, ...middle()),
    0: fit,
    "/": () => filter.focus(),
    "?": () => document.getElementById("help").toggleAttribute("open"),
    Escape: () => tell(""),
    i: () => follow("to", "from"),
    n: () => step(1),
    o: () => follow("from", "to"),
    p: () => step(-1),
    t: toggle,
  };

  function inFilter(event) {
    if (event.key === "Escape") {
      filter.value = "";
      apply();
      filter.blur();
    } else if (event.key === "Enter") {
      choose(matching()[0]);
      filter.blur();
    }
  }

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.target === filter) inFilter(event);
    else if (keys[event.key]) {
      event.preventDefault();
      keys[event.key]();
    } else if (pans[event.key] && list.hidden) {
      event.preventDefault();
      view[0] += (pans[event.key][0] * view[2]) / 10;
      view[1] += (pans[event.key][1] * view[3]) / 10;
      show();
    }
  });
})();
