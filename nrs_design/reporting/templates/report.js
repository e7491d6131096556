"use strict";
// Without this script the page says and shows all there is; it adds what a pointer can ask for.

function button(text, label, act) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.setAttribute("aria-label", label);
  made.addEventListener("click", act);
  return made;
}

function addTheme() {
  const root = document.documentElement;
  const dark = () => (root.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
  const toggle = button("", "", () => { root.dataset.theme = dark() ? "light" : "dark"; name(); });
  function name() {
    toggle.textContent = dark() ? "Light" : "Dark";
    toggle.setAttribute("aria-label", `${toggle.textContent} page`);
  }
  toggle.className = "theme";
  name();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", name);
  document.querySelector("header").append(toggle);
}

// What the axes of a figure are, each [left, top, right, bottom, x low, x high, y low, y high, log x, log y].
function place(svg, x, y) {
  for (const [l, t, r, b, xl, xh, yl, yh, lx, ly] of JSON.parse(svg.dataset.axes)) {
    if (x < l || x > r || y < t || y > b) continue;
    const at = (share, low, high, log) => log ? low * (high / low) ** share : low + share * (high - low);
    const [u, v] = [at((x - l) / (r - l), xl, xh, lx), at((b - y) / (b - t), yl, yh, ly)];
    return [u, v].map((value) => Number(value.toPrecision(4)).toString().replace("-", "−")).join(", ");
  }
  return "";
}

// The name of what is drawn within a few pixels of a pointer.
function named(svg, x, y) {
  for (const [dx, dy] of [[0, 0], [0, 4], [0, -4], [4, 0], [-4, 0], [3, 3], [-3, -3], [3, -3], [-3, 3]]) {
    const found = document.elementFromPoint(x + dx, y + dy)?.closest("[data-named]");
    if (found && svg.contains(found)) return found.querySelector(":scope > title").textContent;
  }
  return "";
}

function addTools(svg) {
  const whole = svg.getAttribute("viewBox").split(" ").map(Number);
  let box = whole;
  const show = (next) => { box = next; svg.setAttribute("viewBox", box.join(" ")); };
  function zoom(factor, u = 0.5, v = 0.5) {
    const [w, h] = [Math.min(box[2] * factor, whole[2]), Math.min(box[3] * factor, whole[3])];
    move(box[0] + u * (box[2] - w), box[1] + v * (box[3] - h), w, h);
  }
  function move(x, y, w, h) {
    const inside = (value, low, length, size) => Math.max(low, Math.min(value, low + length - size));
    show([inside(x, whole[0], whole[2], w), inside(y, whole[1], whole[3], h), w, h]);
  }
  const told = document.createElement("output");
  const bar = document.createElement("div");
  const title = svg.parentElement.querySelector("h3").textContent;
  bar.className = "tools";
  bar.append(told, button("+", `Zoom in: ${title}`, () => zoom(0.5)), button("−", `Zoom out: ${title}`, () => zoom(2)), button("All", `Show all: ${title}`, () => show(whole)));
  svg.before(bar);

  let held = null;
  svg.addEventListener("pointermove", (event) => {
    const area = svg.getBoundingClientRect();
    const [u, v] = [(event.clientX - area.left) / area.width, (event.clientY - area.top) / area.height];
    if (held) move(held.box[0] - (u - held.u) * box[2], held.box[1] - (v - held.v) * box[3], box[2], box[3]);
    const at = place(svg, box[0] + u * box[2], box[1] + v * box[3]);
    const name = at && named(svg, event.clientX, event.clientY);
    told.textContent = [name, at && `(${at})`].filter(Boolean).join(" ");
  });
  svg.addEventListener("pointerdown", (event) => {
    const area = svg.getBoundingClientRect();
    if (box[2] === whole[2] && box[3] === whole[3]) return;
    held = { u: (event.clientX - area.left) / area.width, v: (event.clientY - area.top) / area.height, box };
    svg.setPointerCapture(event.pointerId);
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => { held = null; });
  svg.addEventListener("pointerleave", () => { told.textContent = ""; });
  svg.addEventListener("dblclick", (event) => {
    const area = svg.getBoundingClientRect();
    zoom(0.5, (event.clientX - area.left) / area.width, (event.clientY - area.top) / area.height);
  });
}

// A link into a folded part, or a printer, opens it.
function unfold(inner) {
  for (let fold = inner?.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  const own = inner?.querySelector(":scope > details");
  if (own) own.open = true;
}

function follow() {
  const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target) { unfold(target); target.scrollIntoView(); }
}

addTheme();
addEventListener("hashchange", follow);
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((fold) => { fold.open = true; }));
follow();
document.querySelectorAll("figure svg").forEach(addTools);
