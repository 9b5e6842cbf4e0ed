"use strict";
// Keys, filters, the slider. Every page can be read without this script; on disk it filters, as no server does.
const all = (selector) => [...document.querySelectorAll(selector)];
const byId = (id) => document.getElementById(id);

// ---- a room in 3D, whose script and model come later
if (byId("state")) byId("state").textContent = "The room is being loaded …";

// ---- the list
const form = byId("filters");
const showAsked = () => { // whoever comes back finds what a browser has kept, and not what the address says
  const asked = new URLSearchParams(location.search);
  for (const control of form.elements) if (control.name) control.value = asked.get(control.name) || "";
};
const filterHere = () => {
  const asked = new URLSearchParams(location.search);
  const words = (asked.get("q") || "").toLowerCase().split(/\s+/).filter(Boolean).slice(0, 12);
  const fits = (item) => {
    for (const select of form.querySelectorAll("select")) {
      const value = asked.get(select.name);
      if (value && item.dataset[select.name] !== value) return false;
    }
    const text = `${item.querySelector(".question").textContent} ${item.dataset.text}`.toLowerCase();
    return words.every((word) => text.includes(word));
  };
  const items = all("#cards > li");
  const found = items.filter(fits);
  const size = Number(byId("cards").dataset.pageSize);
  const pages = Math.max(1, Math.ceil(found.length / size));
  const page = Math.min(Math.max(Number.parseInt(asked.get("page"), 10) || 1, 1), pages);
  const shown = new Set(found.slice((page - 1) * size, page * size));
  for (const item of items) item.hidden = !shown.has(item);
  byId("count").textContent = found.length.toLocaleString("en");
  byId("none").hidden = found.length > 0;
  byId("page").textContent = page;
  byId("pages").textContent = pages;
  document.querySelector(".paging").hidden = pages === 1;
  for (const [rel, to] of [["prev", page - 1], ["next", page + 1]]) {
    const link = document.querySelector(`.paging [rel=${rel}]`);
    asked.set("page", to);
    link.href = `?${asked}`;
    link.hidden = to < 1 || to > pages;
  }
};
if (form) {
  const isStatic = "static" in document.body.dataset;
  const go = () => {
    const asked = new URLSearchParams([...new FormData(form)].filter(([, value]) => value));
    const query = asked.size ? `?${asked}` : "";
    if (isStatic) {
      history.pushState(null, "", location.pathname + query);
      filterHere();
    } else location.assign("index.html" + query);
  };
  form.addEventListener("submit", (event) => { event.preventDefault(); go(); });
  for (const select of form.querySelectorAll("select")) select.addEventListener("change", go);
  addEventListener("pageshow", showAsked);
  if (isStatic) {
    filterHere();
    addEventListener("popstate", () => { showAsked(); filterHere(); });
  }
}

// ---- the walk
const slider = byId("frame");
if (slider) {
  const data = JSON.parse(byId("data").textContent);
  const objects = Number(byId("data").dataset.objects) || 1;
  const pictures = byId("walk").dataset.pictures;
  const line = (text, kind) => {
    const item = document.createElement("li");
    item.textContent = text;
    if (kind) item.className = kind;
    return item;
  };
  const name = (id) => id.split("|")[0];
  const show = () => {
    const number = Number(slider.value);
    const frame = data[number];
    byId("view").src = `${pictures}f${number}.jpg`;
    byId("map").setAttribute("href", number === data.length - 1 ? `${pictures}map.png` : `${pictures}m${number}.png`);
    byId("which").textContent = `${number + 1} of ${data.length}`;
    byId("said").textContent = `${frame.id}: shows ${frame.seen} objects`;
    byId("nodes").textContent = frame.allNodes;
    byId("edges").textContent = frame.allEdges;
    byId("share").setAttribute("width", 100 * frame.allNodes / objects);
    for (const part of all("[data-step]")) {
      const step = Number(part.dataset.step);
      part.setAttribute("visibility", step <= number ? "visible" : "hidden");
      part.classList.toggle("fresh", step === number);
    }
    for (const part of all("[data-only]")) part.setAttribute("visibility", Number(part.dataset.only) === number ? "visible" : "hidden");
    const edges = frame.edges.map((text) => line(text.replace(/\|[^ ]*/g, ""), "relation-line"));
    const lines = [...frame.nodes.map((id) => line(name(id))), ...edges];
    byId("new").replaceChildren(...(lines.length ? lines : [line("nothing")]));
    history.replaceState(null, "", `#${number}`);
  };
  let timer = 0;
  const stop = () => { clearInterval(timer); timer = 0; byId("play").textContent = "▶"; };
  byId("play").addEventListener("click", () => {
    if (timer) return stop();
    if (Number(slider.value) === data.length - 1) slider.value = -1;
    byId("play").textContent = "❚❚";
    timer = setInterval(() => {
      slider.value = Number(slider.value) + 1;
      show();
      if (Number(slider.value) === data.length - 1) stop();
    }, 600);
  });
  slider.addEventListener("input", () => { stop(); show(); });
  const showLinked = () => {
    if (/^#\d+$/.test(location.hash)) slider.value = Math.min(Number(location.hash.slice(1)), data.length - 1);
    show();
  };
  addEventListener("hashchange", () => { stop(); showLinked(); });
  showLinked();
}

// ---- keys
const items = () => all("#cards > li:not([hidden])");
const choose = (step) => {
  const shown = items();
  if (!shown.length) return;
  const now = shown.findIndex((item) => item.classList.contains("chosen"));
  const next = Math.min(Math.max(now + step, 0), shown.length - 1);
  for (const item of all(".chosen")) item.classList.remove("chosen");
  shown[next].classList.add("chosen");
  shown[next].scrollIntoView({ block: "nearest" });
  shown[next].querySelector("a").focus({ preventScroll: true });
};
const follow = (rel) => document.querySelector(`.between [rel=${rel}]`)?.click();
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "range";
  if (typing) {
    if (event.key === "Escape") event.target.blur();
    return;
  }
  if (event.key === "/" && form) { event.preventDefault(); form.elements.q.select(); }
  else if (event.key === "j") form ? choose(1) : follow("next");
  else if (event.key === "k") form ? choose(-1) : follow("prev");
});
