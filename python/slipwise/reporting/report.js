// SPDX-License-Identifier: Apache-2.0
// Draws the figures of the report one after the other, and notes on the html element what went wrong:
// data-figures (how many there are), data-drawn (how often one was drawn), data-errors (messages, empty when all is well).
"use strict";
(() => {
  const state = document.documentElement.dataset;
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
  const sources = Array.from(document.querySelectorAll("script[data-figure]"));
  state.figures = String(sources.length);

  const draw = async (source) => {
    const place = document.getElementById(source.dataset.figure);
    try {
      const figure = JSON.parse(source.textContent);
      figure.layout.dragmode = mouse ? "zoom" : false; // a finger on a figure scrolls the page
      if (figure.layout.scene) figure.layout.dragmode = "turntable";
      const modeBarButtons = figure.layout.scene ? solid : flat;
      await Plotly.newPlot(place, figure.data, figure.layout, { ...config, modeBarButtons });
      place.dataset.drawn = "yes";
      state.drawn = String(Number(state.drawn) + 1);
    } catch (problem) {
      place.textContent = "This figure could not be drawn: " + problem;
      note(source.dataset.figure + ": " + problem);
    }
  };
  // A browser keeps about sixteen drawings in three dimensions; where there are more, only those near the window are.
  const scenes = sources.filter((source) => JSON.parse(source.textContent).layout.scene);
  const passing = new Set(scenes.length > 8 ? scenes : []);
  const nearby = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) {
        Plotly.purge(target);
      } else if (!target.querySelector(".main-svg")) {
        draw(document.querySelector(`script[data-figure="${target.id}"]`));
      }
    }
  }, { rootMargin: "300px" });

  const drawAll = async () => {
    for (const source of sources) {
      if (passing.has(source)) {
        nearby.observe(document.getElementById(source.dataset.figure));
        continue;
      }
      await draw(source);
      await new Promise((resume) => setTimeout(resume)); // lets the page scroll meanwhile
    }
    state.ready = "yes";
  };

  document.querySelectorAll("button[data-log-scale]").forEach((button) => {
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => {
      const pressed = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(pressed));
      Plotly.relayout(button.dataset.logScale, { "yaxis.type": pressed ? "log" : "linear", "yaxis.autorange": true });
    });
  });
  drawAll();
})();
