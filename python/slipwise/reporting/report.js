// SPDX-License-Identifier: Apache-2.0
// Draws the figures of a page one after the other, each when it can be seen for the first time, in the colours that the
// browser asks for. It notes on the html element: data-figures (how many there are), data-drawn (how many were drawn),
// data-errors (messages, empty when all is well), data-ready (yes: what is not folded away was drawn).
"use strict";
(() => {
  const root = document.documentElement;
  const state = root.dataset;
  const errors = [];
  const note = (message) => {
    errors.push(String(message));
    state.errors = errors.join(" | ");
  };
  state.errors = "";
  state.drawn = "0";
  window.addEventListener("error", (event) => note(event.message));
  window.addEventListener("unhandledrejection", (event) => note(event.reason));
  document.addEventListener("securitypolicyviolation", (event) => note("refused: " + event.violatedDirective));

  const mouse = window.matchMedia("(hover: hover)").matches;
  // Every button is named here: none that a version of Plotly adds, such as one that uploads the chart, comes by itself.
  const saved = ["toImage"];
  const flat = [saved, ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]];
  const solid = [saved, ["orbitRotation", "pan3d", "zoom3d"], ["resetCameraDefault3d"]];
  const config = {
    responsive: true,
    displayModeBar: mouse ? "hover" : false,
    displaylogo: false,
    showTips: false,
    plotlyServerURL: "",
  };
  const sources = new Map(
    Array.from(document.querySelectorAll("script[data-figure]"), (source) => [source.dataset.figure, source]),
  );
  state.figures = String(sources.size);

  // Colours: the page's style declares a variable for each that is another one on a dark page.
  const twin = (hex) => getComputedStyle(root).getPropertyValue("--c-" + hex.slice(1)).trim() || hex;
  const two = (number) => Number(number).toString(16).padStart(2, "0");
  const coloured = (text) => {
    if (/^#[0-9a-f]{6}$/.test(text)) return twin(text);
    const parts = /^rgba\((\d+),(\d+),(\d+),([\d.]+)\)$/.exec(text);
    if (!parts) return text;
    const shown = twin("#" + two(parts[1]) + two(parts[2]) + two(parts[3]));
    const numbers = [1, 3, 5].map((at) => parseInt(shown.slice(at, at + 2), 16));
    return `rgba(${numbers.join(",")},${parts[4]})`;
  };
  const themed = (value) => {
    if (typeof value === "string") return coloured(value);
    if (Array.isArray(value)) return value.map(themed);
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, themed(item)]));
  };

  const logButton = (name) => document.querySelector(`button[data-log-scale="${name}"]`);
  const pressed = (button) => button !== null && button.getAttribute("aria-pressed") === "true";
  const drawn = new Set();
  const draw = async (name) => {
    const place = document.getElementById(name);
    try {
      const figure = themed(JSON.parse(sources.get(name).textContent));
      figure.layout.dragmode = mouse ? "zoom" : false; // a finger on a figure scrolls the page
      if (figure.layout.scene) figure.layout.dragmode = "turntable";
      if (pressed(logButton(name))) figure.layout.yaxis.type = "log";
      const modeBarButtons = figure.layout.scene ? solid : flat;
      await Plotly.react(place, figure.data, figure.layout, { ...config, modeBarButtons });
      place.dataset.drawn = "yes";
      drawn.add(name);
      state.drawn = String(drawn.size);
    } catch (problem) {
      place.textContent = "This figure could not be drawn: " + problem;
      note(name + ": " + problem);
    }
  };

  // A browser keeps about sixteen drawings in three dimensions; where there are more, only those near the window are.
  const scenes = Array.from(sources.keys()).filter((name) => JSON.parse(sources.get(name).textContent).layout.scene);
  const passing = new Set(scenes.length > 8 ? scenes : []);
  const nearby = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) {
        Plotly.purge(target);
      } else if (!target.querySelector(".main-svg")) {
        draw(target.id);
      }
    }
  }, { rootMargin: "300px" });

  const folded = (name) => document.getElementById(name).closest("details:not([open])") !== null;
  const drawAll = async (again) => {
    for (const name of sources.keys()) {
      if (passing.has(name)) {
        nearby.observe(document.getElementById(name));
        if (again && document.getElementById(name).querySelector(".main-svg")) await draw(name);
      } else if (again ? drawn.has(name) : !drawn.has(name) && !folded(name)) {
        await draw(name);
        await new Promise((resume) => setTimeout(resume)); // lets the page scroll meanwhile
      }
    }
    state.ready = "yes";
  };
  let last = Promise.resolve(); // one pass at a time
  const pass = (again) => {
    last = last.then(() => drawAll(again));
    return last;
  };

  document.addEventListener("toggle", (event) => {
    if (!event.target.open) return;
    for (const place of event.target.querySelectorAll(".plot[data-drawn]")) {
      if (!folded(place.id) && place.querySelector(".main-svg")) Plotly.Plots.resize(place);
    }
    pass(false);
  }, true);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => pass(true));

  const sections = Array.from(document.querySelectorAll("details.section"));
  const unfold = (open) => sections.forEach((section) => (section.open = open));
  document.querySelectorAll("button[data-unfold]").forEach((button) => {
    button.addEventListener("click", () => {
      const open = sections.some((section) => !section.open);
      unfold(open);
      button.textContent = open ? "fold all" : "unfold all";
    });
  });
  window.addEventListener("beforeprint", () => unfold(true));
  document.querySelectorAll("button[data-log-scale]").forEach((button) => {
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => {
      button.setAttribute("aria-pressed", String(!pressed(button)));
      last = last.then(() => { // one that is not drawn yet is drawn as the button says
        const axis = { "yaxis.type": pressed(button) ? "log" : "linear", "yaxis.autorange": true };
        if (drawn.has(button.dataset.logScale)) Plotly.relayout(button.dataset.logScale, axis);
      });
    });
  });
  pass(false);
})();
