# SPDX-License-Identifier: Apache-2.0
"""A Plotly figure as data: serialised with few digits, drawn by the page's script."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.reporting.markup import escape

DIGITS = 6  # significant digits of every number in a figure
TOP_BAR_MARGIN = {"t": 42}  # px above a plot for a colour bar
LEGEND_ON_TOP = {"showlegend": True, "legend": {"orientation": "h", "y": 1.12}, "margin": {"t": 40}}

_AXIS = {
    "gridcolor": "#e6eaef",
    "zerolinecolor": "#c3cad3",
    "linecolor": "#9aa5b1",
    "ticks": "outside",
    "tickcolor": "#9aa5b1",
    "automargin": True,
}
_FONT = {"family": "system-ui, -apple-system, 'Segoe UI', Roboto, 'Liberation Sans', Arial, sans-serif"}
CURVE_POINTS = 400  # of one curve over the page; more cannot be distinguished on a screen
SMALL_POINTS = 150  # of one curve in a small figure


@dataclass(frozen=True)
class Figure:
    """One figure; `key` is unique on the page, `label` says in words what it shows."""

    key: str
    label: str
    traces: list[dict[str, Any]]
    layout: dict[str, Any] = field(default_factory=dict)
    height: int = 360  # [px]
    aspect: float | None = None  # height over width of what is drawn, for a map: low ones are made less high
    caption: str = ""
    heading: str = ""
    log_scale: bool = False  # offer a button that makes the y axis logarithmic

    def html(self) -> str:
        """Return the figure's place on the page and its data."""
        name = f"figure-{self.key}"
        heading = f"<h3>{escape(self.heading)}</h3>" if self.heading else ""
        caption = f"<figcaption>{escape(self.caption)}</figcaption>" if self.caption else ""
        button = (
            f'<button type="button" data-log-scale="{escape(name)}">log scale</button>'
            if self.log_scale
            else ""
        )
        return (
            f'<figure><div class="figure-head">{heading}{button}</div>'
            f'<div class="plot" id="{escape(name)}" style="height:{self._css_height()}" role="img" '
            f'aria-label="{escape(self.label)}"></div>'
            f'<script type="application/json" data-figure="{escape(name)}">{self.json()}</script>'
            f"{caption}</figure>"
        )

    def _css_height(self) -> str:
        if self.aspect is None:
            return f"{self.height}px"
        return f"clamp(260px, calc({self.aspect:.2f} * 88vw + 110px), {self.height}px)"

    def json(self) -> str:
        """Return traces and layout as JSON that may stand inside a script element."""
        layout = _merged(_standard_layout(), self.layout)
        text = json.dumps(
            _plain({"data": self.traces, "layout": layout}), allow_nan=False, separators=(",", ":")
        )
        return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def axis(title: str, *, small: bool = False, **options: object) -> dict[str, Any]:
    """Return an axis with a title; the unit belongs into the title."""
    size = {"size": 11} if small else {"size": 13}
    return {**_AXIS, "title": {"text": title, "font": size, "standoff": 3 if small else 6}, **options}


def curve(x: ArrayLike, y: ArrayLike, *, mode: str = "lines", **options: object) -> dict[str, Any]:
    """Return a trace of points, joined by lines unless its mode says otherwise."""
    return {"type": "scatter", "mode": mode, "x": numbers(x), "y": numbers(y), **options}


def step_lines(t: ArrayLike, curves: Mapping[str, tuple[ArrayLike, str]]) -> Figure:
    """Return commands over time, each held until the next: curves by their name with unit, and colours."""
    return Figure(
        key="commands",
        label="commanded speed and yaw rate over time",
        traces=[
            curve(t, values, name=name, line={"shape": "hv", "color": colour})
            for name, (values, colour) in curves.items()
        ],
        layout={"xaxis": axis("time [s]"), "yaxis": axis(", ".join(curves)), **LEGEND_ON_TOP},
        height=280,
    )


def map_axes(left: float, right: float, bottom: float, top: float) -> dict[str, Any]:
    """Return axes of a map of this extent [m], with equal scales."""
    return {
        "xaxis": axis("x [m]", range=[left, right], constrain="domain"),
        "yaxis": axis("y [m]", range=[bottom, top], scaleanchor="x", constrain="domain"),
    }


def vertical_lines(
    at: Iterable[float], colour: str, *, dash: str = "solid", width: float = 1.5, yref: str = "paper"
) -> list[dict[str, Any]]:
    """Return shapes: a vertical line from 0 to 1, of the plot or of its axis, at each place."""
    line = {"color": colour, "width": width, "dash": dash}
    return [
        {"type": "line", "xref": "x", "yref": yref, "x0": x, "x1": x, "y0": 0, "y1": 1, "line": line}
        for x in at
    ]


def top_colour_bar(**options: object) -> dict[str, Any]:
    """Return a colour bar above the plot, where it takes no width; the layout needs TOP_BAR_MARGIN.

    It has no title, which Plotly draws into the bar there: the figure's heading says what the colours are.
    """
    place = {
        "orientation": "h",
        "x": 0.5,
        "xanchor": "center",
        "yref": "container",
        "y": 1.0,
        "yanchor": "top",
    }
    return {
        **place,
        "len": 0.9,
        "thickness": 9,
        "outlinewidth": 0,
        "ypad": 2,
        "tickangle": 0,
        "nticks": 5,
        **options,
    }


def baseline_label(text: str) -> str:
    """Return text that came from a user so that Plotly shows it as it is, no markup and no format in it."""
    shown = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return shown.replace("%{", "% {").replace("$", "＄")


def numbers(values: ArrayLike) -> list[Any]:
    """Return an array as nested lists with few digits, None where a value is not finite."""
    return [_plain(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def _standard_layout() -> dict[str, Any]:
    return {
        "font": {**_FONT, "size": 12, "color": "#1b2430"},
        "margin": {"l": 50, "r": 12, "t": 10, "b": 38},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "showlegend": False,
        "hovermode": "closest",
        "modebar": {"bgcolor": "rgba(255,255,255,0.85)", "color": "#566270", "activecolor": "#0b5c8a"},
    }


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in over.items():
        old = merged.get(key)
        merged[key] = _merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged


def _plain(value: Any) -> Any:
    """Return JSON's own types: floats rounded, None for what is not finite, text that UTF-8 can hold."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, bool | int | str) or value is None:
        return value
    real = float(value)
    if not math.isfinite(real):
        return None
    rounded = float(f"{real:.{DIGITS}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e9 else rounded


def thinned(length: int, limit: int = CURVE_POINTS) -> NDArray[np.int64]:
    """Return the indices of at most `limit` evenly spaced entries, the first and the last among them."""
    if length <= limit:
        return np.arange(length, dtype=np.int64)
    return np.unique(np.linspace(0, length - 1, limit).round().astype(np.int64))


def thinning_note(length: int, limit: int = CURVE_POINTS) -> str:
    """Return the sentence that says how a curve was thinned, empty where it was not."""
    if length <= limit:
        return ""
    return f"Drawn thinned: {limit} evenly spaced of {length} points."
