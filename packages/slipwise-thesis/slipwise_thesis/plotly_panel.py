# SPDX-License-Identifier: Apache-2.0
"""A panel as a Plotly figure."""

from __future__ import annotations

from typing import Any

import numpy as np

from slipwise.reporting.figure import Figure, axis, baseline_label, numbers
from slipwise.reporting.palette import BAND, DIVERGING, transparent
from slipwise_thesis.panel import (
    Band,
    Bars,
    ErrorBars,
    Heat,
    Line,
    Panel,
    Points,
    Series,
    Surface,
)

_SYMBOLS = {
    "dot": "circle",
    "ring": "circle-open",
    "cross": "x-thin-open",
    "square": "square",
    "diamond": "diamond",
}
Trace = dict[str, Any]


def plotly_panel(key: str, panel: Panel) -> Figure:
    """Return the figure of a panel; `key` is unique on the page."""
    traces: list[Trace] = []
    for series, colour in panel.coloured():
        traces += _traces(series, colour, solid=panel.solid)
    return Figure(
        key=key,
        label=panel.title,
        heading=panel.title,
        traces=traces,
        layout=_scene(panel) if panel.solid else _axes(panel),
        height=380,
    )


def _traces(series: Series, colour: str, *, solid: bool) -> list[Trace]:
    match series:
        case Line():
            return [_line(series, colour)]
        case Points():
            return [_points(series, colour, solid=solid)]
        case ErrorBars():
            return [_error_bars(series, colour)]
        case Band():
            return [_band(series, colour)]
        case Bars():
            return [_bars(series, colour)]
        case Surface():
            return _surface(series)
        case Heat():
            return [_heat(series)]


def _line(line: Line, colour: str) -> Trace:
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(line.x),
        "y": numbers(line.y),
        "name": baseline_label(line.label),
        "opacity": line.opacity,
        "line": {"color": colour, "width": line.width, "dash": line.dash},
        "hoverinfo": "x+y+name" if line.label else "x+y",
    }


def _points(points: Points, colour: str, *, solid: bool) -> Trace:
    marker = {"color": colour, "size": points.size, "symbol": _SYMBOLS[points.mark]}
    trace = {
        "mode": "markers",
        "x": numbers(points.x),
        "y": numbers(points.y),
        "name": baseline_label(points.label),
        "opacity": points.opacity,
    }
    if not solid:
        if points.mark in ("cross", "ring"):
            marker["line"] = {"color": colour, "width": 1.4}
        return {**trace, "type": "scatter", "marker": marker}
    z = np.zeros_like(points.x) if points.z is None else points.z
    symbols = {"ring": "circle-open", "square": "square", "diamond": "diamond", "cross": "x"}
    marker |= {"symbol": symbols.get(points.mark, "circle"), "size": 0.7 * points.size}
    return {**trace, "type": "scatter3d", "z": numbers(z), "marker": marker}


def _error_bars(bars: ErrorBars, colour: str) -> Trace:
    return {
        "type": "scatter",
        "mode": "lines+markers" if bars.joined else "markers",
        "x": numbers(bars.x),
        "y": numbers(bars.y),
        "error_y": {"type": "data", "array": numbers(bars.error), "thickness": 1.2, "width": 3},
        "name": baseline_label(bars.label),
        "marker": {
            "color": colour,
            "size": 6,
            "symbol": _SYMBOLS[bars.mark],
            "line": {"color": colour, "width": 1.2},
        },
        "line": {"color": colour, "width": 1},
    }


def _band(band: Band, colour: str) -> Trace:
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(np.concatenate((band.x, band.x[::-1]))),
        "y": numbers(np.concatenate((band.high, band.low[::-1]))),
        "fill": "toself",
        "fillcolor": transparent(colour, 0.22),
        "line": {"width": 0, "color": colour},
        "name": baseline_label(band.label),
        "hoverinfo": "skip",
    }


def _bars(bars: Bars, colour: str) -> Trace:
    trace: Trace = {
        "type": "bar",
        "x": [baseline_label(name) for name in bars.names],
        "y": numbers(bars.values),
        "name": baseline_label(bars.label),
        "marker": {"color": colour},
    }
    if bars.error is not None:
        trace["error_y"] = {"type": "data", "array": numbers(bars.error), "thickness": 1.2, "width": 3}
    return trace


def _surface(surface: Surface) -> list[Trace]:
    limit = float(np.abs(surface.z).max()) or 1.0
    plane = {"type": "surface", "x": numbers(surface.x), "y": numbers(surface.y), "showscale": False}
    mean = {**plane, "z": numbers(surface.z), "colorscale": DIVERGING, "cmin": -limit, "cmax": limit}
    if surface.std is None:
        return [mean]
    sheet = {**plane, "opacity": 0.28, "colorscale": [[0, BAND], [1, BAND]], "hoverinfo": "skip"}
    return [mean, *({**sheet, "z": numbers(surface.z + sign * surface.std)} for sign in (1, -1))]


def _heat(heat: Heat) -> Trace:
    return {
        "type": "heatmap",
        "x": [baseline_label(name) for name in heat.columns],
        "y": [baseline_label(name) for name in heat.rows],
        "z": numbers(heat.values),
        "colorscale": DIVERGING,
        "zmin": -heat.limit,
        "zmax": heat.limit,
        "colorbar": {"thickness": 10, "outlinewidth": 0},
    }


def _axes(panel: Panel) -> Trace:
    powers: Trace = {"type": "log", "exponentformat": "power"}
    x = axis(panel.x_label, **(powers if panel.log_x else {}))
    y = axis(panel.y_label, **(powers if panel.log_y else {}))
    if panel.x_names:
        x |= {
            "tickvals": list(range(len(panel.x_names))),
            "ticktext": [baseline_label(n) for n in panel.x_names],
        }
    if panel.equal_axes:
        y |= {"scaleanchor": "x", "scaleratio": 1}
    if any(isinstance(series, Heat) for series in panel.series):
        y |= {"autorange": "reversed"}
    return {"xaxis": x, "yaxis": y, "barmode": "group"}


def _scene(panel: Panel) -> Trace:
    small = {"tickfont": {"size": 10}, "nticks": 5, "gridcolor": "#d5dbe1", "backgroundcolor": "#f7f9fa"}

    def scene_axis(text: str) -> Trace:
        return {**small, "showbackground": True, "title": {"text": text, "font": {"size": 12}}}

    return {
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "scene": {
            "xaxis": scene_axis(panel.x_label),
            "yaxis": scene_axis(panel.y_label),
            "zaxis": scene_axis(panel.z_label),
            "aspectmode": "cube",
            "camera": {"eye": {"x": 1.6, "y": 1.6, "z": 0.9}, "center": {"x": 0, "y": 0, "z": -0.1}},
        },
    }
