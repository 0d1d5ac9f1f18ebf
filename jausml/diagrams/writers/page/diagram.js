"use strict";
// The page of one diagram: zoom, pan, filter, details. Texts of the model are set as text alone.
(() => {
  const svg = document.querySelector("svg");
  const known = JSON.parse(document.getElementById("known").textContent);
  const filter = document.getElementById("filter");
  const details = document.getElementById("details");
  const whole = svg.getAttribute("viewBox").split(" ").map(Number);
  const drawn = [...svg.querySelectorAll("[data-key]")];
  let view = [...whole];

  function show() {
    svg.setAttribute("viewBox", view.join(" "));
  }

  function zoom(factor, x, y) {
    const wanted = Math.min(Math.max(view[2] * factor, whole[2] / 40), whole[2] * 2);
    const real = wanted / view[2];
    view = [x - (x - view[0]) * real, y - (y - view[1]) * real, wanted, view[3] * real];
    show();
  }

  function place(event) {
    const point = new DOMPoint(event.clientX, event.clientY);
    return point.matrixTransform(svg.getScreenCTM().inverse());
  }

  function middle() {
    return [view[0] + view[2] / 2, view[1] + view[3] / 2];
  }

  function fit() {
    view = [...whole];
    show();
  }

  function matches(key, words) {
    const text = (known[key] ? known[key].text : "").toLowerCase();
    return words.every((word) => text.includes(word));
  }

  function apply() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = new Set();
    for (const key of Object.keys(known)) {
      if (!matches(key, words)) continue;
      kept.add(key);
      for (const end of known[key].ends) kept.add(end);
    }
    for (const each of drawn) each.classList.toggle("faded", !kept.has(each.dataset.key));
  }

  function line(tag, text, kind) {
    const made = document.createElement(tag);
    made.textContent = text;
    if (kind) made.className = kind;
    details.append(made);
  }

  function tell(key) {
    details.replaceChildren();
    for (const each of drawn) each.classList.toggle("chosen", each.dataset.key === key);
    const found = known[key];
    details.hidden = !found;
    if (!found) return;
    line("h2", found.title);
    for (const [kind, text] of found.findings) line("p", `${kind}: ${text}`, kind);
    for (const [name, text] of found.details) {
      line("h3", name);
      line("p", text);
    }
  }

  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    const at = place(event);
    zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, at.x, at.y);
  }, { passive: false });

  let held = null;
  let moved = false;
  svg.addEventListener("pointerdown", (event) => {
    held = place(event);
    moved = false;
  });
  svg.addEventListener("pointermove", (event) => {
    if (!held || !event.buttons) return;
    const at = place(event);
    moved = moved || Math.hypot(at.x - held.x, at.y - held.y) > view[2] / 300;
    view[0] += held.x - at.x;
    view[1] += held.y - at.y;
    show();
  });
  svg.addEventListener("pointerup", (event) => {
    held = null;
    if (moved) return;
    const chosen = event.target.closest("[data-key]");
    tell(chosen ? chosen.dataset.key : "");
  });

  filter.addEventListener("input", apply);
  document.getElementById("fit").addEventListener("click", fit);
  document.getElementById("closer").addEventListener("click", () => zoom(1 / 1.4, ...middle()));
  document.getElementById("further").addEventListener("click", () => zoom(1.4, ...middle()));
  document.addEventListener("keydown", (event) => {
    if (event.target === filter) {
      if (event.key === "Escape") {
        filter.value = "";
        apply();
        filter.blur();
      }
      return;
    }
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key === "+") zoom(1 / 1.4, ...middle());
    else if (event.key === "-") zoom(1.4, ...middle());
    else if (event.key === "0") fit();
    else if (event.key === "/") {
      event.preventDefault();
      filter.focus();
    } else if (event.key === "Escape") tell("");
    else if (step[event.key]) {
      view[0] += (step[event.key][0] * view[2]) / 10;
      view[1] += (step[event.key][1] * view[3]) / 10;
      show();
    }
  });
})();
