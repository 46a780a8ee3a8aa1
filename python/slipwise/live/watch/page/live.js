// SPDX-License-Identifier: Apache-2.0
// Fills the live page from the stream of events. Text from the robot goes through textContent alone. It notes on the html
// element: data-connection (connecting, live, quiet, lost), data-updates (how many came), data-errors (empty when well).
"use strict";
(() => {
  const SILENCE = 3000; // ms without any event: the stream is lost
  const QUIET = 3000; // ms without a new state: the node says nothing
  const RETRY = 1500; // ms
  const FASTEST = 250; // ms between two drawings
  const root = document.documentElement;
  const noted = root.dataset;
  const at = (name) => document.getElementById(name);
  const problems = [];
  const note = (message) => {
    problems.push(String(message));
    noted.errors = problems.slice(-5).join(" | ");
  };
  noted.errors = "";
  noted.updates = "0";
  noted.connection = "connecting";
  window.addEventListener("error", (event) => note(event.message));
  window.addEventListener("unhandledrejection", (event) => note(event.reason));
  document.addEventListener("securitypolicyviolation", (event) => note("refused: " + event.violatedDirective));

  const put = (place, text) => {
    if (place.textContent !== text) place.textContent = text;
  };
  const make = (tag, kind, text) => {
    const element = document.createElement(tag);
    if (kind) element.className = kind;
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const shape = (tag, kind, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    if (kind) element.setAttribute("class", kind);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
    return element;
  };
  const minus = (text) => text.replace(/^-/, "−");
  const seconds = (value) => (value < 10 ? value.toFixed(1) : value.toFixed(0)) + " s";

  const OF_VALIDITY = { estimated: "good", unestimated: "partly", invalid: "bad" };
  const OF_STATE = { learning: "good", waiting: "partly", stuck: "bad" };
  const OF_APPLY = { off: "nothing (off)", manual: "on request", auto: "by itself" };
  const OF_INPUT = { command: "commands", wheel: "wheels" };

  // ---- messages

  const showAnswer = (status) => {
    put(at("vehicle"), status.vehicle || "a robot");
    document.title = (status.vehicle ? status.vehicle + " – " : "") + "slipwise live";
    put(at("state"), status.state);
    put(at("why"), status.why);
    at("state-box").className = "say " + (OF_STATE[status.state] || "");
    put(at("validity"), "model: " + status.validity);
    put(at("validity-why"), status.validityWhy);
    at("validity-box").className = "say " + (OF_VALIDITY[status.validity] || "");
    put(at("stamp"), status.stamp);
    put(at("input"), OF_INPUT[status.input] || status.input);
    put(at("segments"), String(status.segments));
    at("surface-box").hidden = !status.surface;
    put(at("surface"), status.surface || "–");
    put(at("apply"), OF_APPLY[status.apply] || status.apply);
    put(at("since-pose"), status.sincePose === null ? "–" : status.sincePose < 0.05 ? "now" : seconds(status.sincePose) + " ago");
  };

  let slipScale = 0.1; // the largest seen: bars that rescale themselves cannot be read
  const showSlip = (slip) => {
    if (slip === null) return;
    for (const part of slip) slipScale = Math.max(slipScale, Math.abs(part.value ?? 0));
    const rows = slip.map((part) => {
      const row = make("div", "amount");
      const rail = make("div", "rail centred");
      const bar = make("i");
      const half = (50 * Math.min(Math.abs(part.value ?? 0), slipScale)) / slipScale;
      bar.style.width = half + "%";
      bar.style.left = (part.value ?? 0) < 0 ? 50 - half + "%" : "50%";
      rail.append(bar);
      row.append(make("span", "name", part.name), rail, make("span", "text", minus(part.text) + " " + part.unit));
      return row;
    });
    at("slip").replaceChildren(...rows);
  };

  const showErrors = (errors) => {
    if (errors.length === 0) return;
    const blocks = errors.map((error) => {
      const block = make("div", "error");
      const head = make("h3", "", error.name + " ");
      if (error.ratio !== "–") head.append(make("span", "", error.ratio + " times the baseline's"));
      block.append(head);
      const most = Math.max(Number(error.learned) || 0, Number(error.baseline) || 0) || 1;
      for (const [name, kind, text] of [["learned", "ours", error.learned], ["baseline", "baseline", error.baseline]]) {
        const row = make("div", "amount");
        const rail = make("div", "rail");
        const bar = make("i", kind);
        bar.style.left = "0";
        bar.style.width = (100 * (Number(text) || 0)) / most + "%";
        rail.append(bar);
        row.append(make("span", "name", name), rail, make("span", "text", text + " " + error.unit));
        block.append(row);
      }
      return block;
    });
    at("errors").replaceChildren(...blocks);
  };

  const SPAN = 2; // standard deviations of the prior to either side
  const bar = (p) => {
    const picture = shape("svg", OF_VALIDITY[p.validity] || "", {});
    const x = (value) => 50 + (Math.max(-SPAN, Math.min(SPAN, value)) / (2 * SPAN)) * 96 + "%"; // however wide it is
    picture.append(shape("rect", "prior", { x: x(-1), y: 4, width: 96 / SPAN + "%", height: 12, rx: 2 }));
    picture.append(shape("line", "start", { x1: "50%", x2: "50%", y1: 1, y2: 19 }));
    if (p.at !== null && p.spread !== null) {
      picture.append(shape("line", "spread", { x1: x(p.at - p.spread), x2: x(p.at + p.spread), y1: 10, y2: 10 }));
    }
    if (p.appliedAt !== null) {
      const mark = shape("svg", "", { x: x(p.appliedAt), y: 10, overflow: "visible" });
      mark.append(shape("path", "applied", { d: "M0 -8L4.5 0L0 8L-4.5 0Z" }));
      picture.append(mark);
    }
    if (p.at !== null) picture.append(shape("circle", "value", { cx: x(p.at), cy: 10, r: 4 }));
    const title = shape("title", "", {});
    title.textContent = `${p.name}: ${p.value} ± ${p.std} ${p.unit}`;
    picture.prepend(title);
    return picture;
  };

  const filling = (known) => {
    const rail = make("div", "rail filling" + (known === 1 ? " full" : ""));
    const part = make("i");
    part.style.left = "0";
    part.style.width = 100 * (known ?? 0) + "%";
    rail.append(part);
    return rail;
  };

  // ---- moves worth driving

  const PICTURE = 88; // px
  const track = (move) => {
    const points = [];
    for (let i = 0; i <= 32; i++) {
      const t = (move.seconds * i) / 32;
      const turn = move.omega * t;
      const arc = Math.abs(turn) < 1e-6 ? 1 : Math.sin(turn / 2) / (turn / 2);
      points.push([-move.v * t * arc * Math.sin(turn / 2), -move.v * t * arc * Math.cos(turn / 2)]); // ahead is up
    }
    return points;
  };
  const movePicture = (move, scale) => {
    const picture = shape("svg", "move", { viewBox: `${-PICTURE / 2} ${-PICTURE / 2} ${PICTURE} ${PICTURE}`, width: PICTURE, height: PICTURE });
    const points = track(move).map(([x, y]) => [x * scale, y * scale]);
    picture.append(shape("path", "driven", { d: "M" + points.map((p) => p.map((n) => n.toFixed(1)).join(" ")).join("L") }));
    const [x, y] = points[points.length - 1];
    const turned = (-move.omega * move.seconds * 180) / Math.PI;
    const body = "M0 -7L5 6L0 3L-5 6Z";
    picture.append(shape("path", "from", { d: body }));
    picture.append(shape("path", "to", { d: body, transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${turned.toFixed(1)})` }));
    return picture;
  };
  let shownNext = null;
  const showNext = (next) => {
    const key = JSON.stringify(next);
    if (next === null || key === shownNext) return;
    shownNext = key;
    const far = Math.max(0.1, ...next.moves.flatMap((move) => track(move).flat().map(Math.abs)));
    const items = next.moves.map((move) => {
      const item = make("li");
      const words = make("div");
      words.append(
        make("strong", "", move.text),
        make("p", "", `hold ${move.seconds} s, then the worst is ${move.after}`),
        make("p", "", "teaches most of " + move.teaches),
      );
      item.append(movePicture(move, (PICTURE / 2 - 9) / far), words);
      return item;
    });
    at("moves").replaceChildren(...(items.length ? items : [make("li", "empty", next.why || "Not known yet.")]));
    const rows = next.sure.map((part) => {
      const row = make("div", "amount sure");
      row.append(make("span", "name", "worst " + part.name), filling(part.known), make("span", "text", part.text));
      return row;
    });
    at("sure").replaceChildren(...rows);
  };

  const cell = (kind, label, text) => {
    const one = make("td", kind, text);
    if (label) one.dataset.label = label;
    return one;
  };
  let shownParameters = null;
  const showParameters = (parameters) => {
    const key = JSON.stringify(parameters);
    if (key === shownParameters) return;
    shownParameters = key;
    const rows = parameters.map((p) => {
      const row = make("tr");
      const name = make("td", "name", p.name);
      if (p.unit) name.append(make("small", "", p.unit));
      const picture = make("td", "bar");
      picture.append(bar(p));
      const sure = make("td", "known");
      if (p.known !== null) sure.append(filling(p.known));
      const state = make("td", "state");
      state.append(make("span", "validity " + (OF_VALIDITY[p.validity] || ""), p.validity));
      row.append(
        name,
        make("td", "number value", minus(p.value) + " ± " + p.std),
        picture,
        sure,
        cell("number quiet", "prior ±", p.prior),
        cell("number quiet", "at start", minus(p.start)),
        cell("number quiet", "applied", minus(p.applied)),
        state,
      );
      return row;
    });
    if (rows.length === 0) {
      const row = make("tr");
      const only = make("td", "empty", "Nothing was learned yet.");
      only.colSpan = 8;
      row.append(only);
      rows.push(row);
    }
    at("parameters").tBodies[0].replaceChildren(...rows);
  };

  const showCounts = (counts) => {
    const rows = counts
      .filter(([, count]) => count > 0)
      .map(([reason, count]) => {
        const row = make("tr");
        row.append(make("td", "", reason), make("td", "", count.toLocaleString("en")));
        return row;
      });
    if (rows.length === 0) {
      const row = make("tr");
      row.append(make("td", "empty", "Nothing was left out."));
      rows.push(row);
    }
    at("counts").tBodies[0].replaceChildren(...rows);
  };

  const showLog = (log) => {
    const lines = log.map(([stamp, text]) => {
      const line = make("li");
      line.append(make("time", "", stamp), make("span", "", text));
      return line;
    });
    at("log").replaceChildren(...(lines.length ? lines : [make("li", "empty", "Nothing yet.")]));
  };

  // ---- figures

  const twin = (hex) => getComputedStyle(root).getPropertyValue("--c-" + hex.slice(1)).trim() || hex;
  const config = { displayModeBar: false, displaylogo: false, showTips: false, plotlyServerURL: "" };
  const line = (colour, width, dash) => ({ color: twin(colour), width, dash: dash || "solid" });
  const base = (margin) => ({
    font: { color: twin("#1b2430"), size: 12, family: "system-ui, 'Liberation Sans', Arial, sans-serif" },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    showlegend: false,
    dragmode: false,
    hovermode: "closest",
    margin,
  });
  const axis = (title, more) => ({
    title: { text: title, standoff: 4 },
    gridcolor: twin("#e6eaef"),
    zerolinecolor: twin("#d5dbe1"),
    linecolor: twin("#9aa5b1"),
    fixedrange: true,
    ...more,
  });
  const trace = (points, more) => ({ type: "scatter", mode: "lines", x: points[0] || [], y: points[1] || [], ...more });

  // The size is given with each drawing, since the cards beside a figure grow as there is more to show.
  const fill = (name, data, layout) => {
    const place = at(name);
    return Plotly.react(place, data, { ...layout, width: place.clientWidth, height: place.clientHeight }, config);
  };

  const AROUND = 3; // m to each side of the robot at the least
  let follow = false;
  at("follow").addEventListener("click", () => {
    follow = !follow;
    at("follow").setAttribute("aria-pressed", String(follow));
    plan();
  });

  const drawPath = (path, frame) => {
    const outlines = [[], []];
    for (const [x, y] of path.ellipses) {
      outlines[0].push(...x, null);
      outlines[1].push(...y, null);
    }
    const here = path.robot && path.robot[0] !== null ? path.robot : null;
    const ahead = path.predicted.length && here ? [[here[0], ...path.predicted[0]], [here[1], ...path.predicted[1]]] : path.predicted;
    const data = [
      trace(path.driven, { name: "measured", line: line("#c3cad3", 6), hovertemplate: "%{x:.2f}, %{y:.2f} m" }),
      trace(path.fused, { name: "fused", line: line("#0072b2", 2), hovertemplate: "%{x:.2f}, %{y:.2f} m" }),
      trace(outlines, { name: "95 %", line: line("#009e73", 1), fill: "toself", opacity: 0.5, hoverinfo: "skip" }),
      trace(ahead, { name: "predicted", line: line("#009e73", 3, "dash"), hovertemplate: "%{x:.2f}, %{y:.2f} m" }),
      {
        type: "scatter",
        mode: "markers",
        name: "robot",
        x: here ? [here[0]] : [],
        y: here ? [here[1]] : [],
        hoverinfo: "skip",
        marker: {
          symbol: "arrow",
          size: 17,
          angle: here && here[2] !== null ? [90 - (here[2] * 180) / Math.PI] : [0],
          color: twin("#0072b2"),
          line: { color: twin("#ffffff"), width: 1.5 },
        },
      },
    ];
    const where = frame ? " in " + frame : "";
    const layout = base({ l: 46, r: 8, t: 6, b: 38 });
    layout.xaxis = axis("x" + where + " [m]", { nticks: 7 });
    layout.yaxis = axis("y [m]", { scaleanchor: "x", scaleratio: 1, nticks: 8 });
    if (follow && here) {
      const wide = at("path").clientWidth - 54; // what the margins leave
      const high = at("path").clientHeight - 44;
      const half = AROUND * Math.max(1, wide / high);
      layout.xaxis.range = [here[0] - half, here[0] + half];
      layout.yaxis.range = [here[1] - (half * high) / wide, here[1] + (half * high) / wide];
    }
    return fill("path", data, layout);
  };

  const drawNis = (nis) => {
    const x = nis.map((point) => point[0]);
    const layout = base({ l: 46, r: 8, t: 4, b: 34 });
    layout.xaxis = axis("segments before the newest", { nticks: 6, zeroline: false, range: x.length > 1 ? undefined : [-20, 1] });
    layout.yaxis = axis("", { type: "log", range: [-1.3, 2], tickvals: [0.1, 1, 3, 10, 100], ticktext: ["0.1", "1", "3", "10", "100"] });
    layout.shapes = [
      { type: "rect", xref: "paper", x0: 0, x1: 1, y0: 0.216, y1: 9.35, fillcolor: twin("#e6d6ad"), opacity: 0.45, line: { width: 0 }, layer: "below" },
      { type: "line", xref: "paper", x0: 0, x1: 1, y0: 3, y1: 3, line: line("#9aa5b1", 1, "dash") },
    ];
    const y = nis.map((point) => (point[1] === null ? null : Math.min(Math.max(point[1], 0.05), 100)));
    const said = nis.map((point) => (point[1] === null ? "" : String(Number(point[1].toPrecision(2)))));
    const marks = { color: twin("#0072b2"), size: 5 };
    const data = [{ type: "scatter", mode: "markers", x, y, text: said, hovertemplate: "NIS %{text}<extra></extra>", marker: marks }];
    return fill("nis", data, layout);
  };

  // ---- the stream

  let newest = null;
  let drawnAt = 0;
  let planned = false;
  const draw = () => {
    planned = false;
    if (newest === null || document.hidden) return;
    drawnAt = performance.now();
    const status = newest.status;
    drawPath(newest.path, status ? status.frame : "");
    drawNis(newest.nis);
    showLog(newest.log);
    showNext(newest.next);
    if (status === null) return;
    showAnswer(status);
    showSlip(status.slip);
    showErrors(status.errors);
    put(at("nis-now"), status.nis === "–" ? "" : status.nis + " in the newest segment");
    showParameters(status.parameters);
    showCounts(status.counts);
    noted.updates = String(Number(noted.updates) + 1);
  };
  const plan = () => {
    if (planned) return;
    planned = true;
    setTimeout(() => requestAnimationFrame(draw), Math.max(0, FASTEST - (performance.now() - drawnAt)));
  };

  let stream = null;
  let latest = performance.now(); // of any message
  let changed = performance.now(); // of a new state
  let retry = null;
  const connect = () => {
    retry = null;
    if (stream) stream.close();
    latest = performance.now();
    stream = new EventSource("events" + location.search);
    stream.addEventListener("state", (event) => {
      const first = newest === null || noted.connection === "lost";
      const before = newest && newest.status ? newest.status.stamp : null;
      newest = JSON.parse(event.data);
      latest = performance.now();
      if (first || (newest.status && newest.status.stamp !== before)) changed = latest;
      watch();
      plan();
    });
    stream.addEventListener("alive", () => {
      latest = performance.now();
      watch();
    });
    stream.addEventListener("error", () => lose());
  };
  const lose = () => {
    noted.connection = "lost";
    put(at("connection-text"), "connection lost, trying again");
    if (stream) stream.close();
    stream = null;
    if (retry === null) retry = setTimeout(connect, RETRY);
  };
  const watch = () => {
    const now = performance.now();
    if (stream === null) return;
    if (now - latest > SILENCE) {
      lose();
    } else if (newest !== null && stream.readyState === EventSource.OPEN) {
      const quiet = newest.status === null || now - changed > QUIET;
      noted.connection = quiet ? "quiet" : "live";
      put(at("connection-text"), !quiet ? "live" : newest.status === null ? "nothing yet" : "nothing new for " + seconds((now - changed) / 1000));
    }
  };
  setInterval(watch, 500);
  new ResizeObserver(plan).observe(at("path"));
  document.addEventListener("visibilitychange", plan);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", plan);
  showParameters([]);
  showCounts([]);
  connect();
})();
