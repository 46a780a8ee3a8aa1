# SPDX-License-Identifier: Apache-2.0
"""The panels of a figure as one small PNG."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipwise.reporting.palette import BAND, DIVERGING
from slipwise.reporting.png_picture import drawing_part, small_png
from slipwise_thesis.panel import Band, Bars, ErrorBars, Heat, Line, Panel, Points, Series, Surface
from slipwise_thesis.thesis_figure import ThesisFigure

DPI = 100
PANEL_SIZE = (4.4, 3.4)  # [in]
SINGLE_SIZE = (6.2, 4.0)  # [in] of a panel that stands alone
LARGEST = 60_000  # [bytes]; a picture that is larger gets fewer colours
MOST_LETTERS = 45  # that fit side by side below a panel
_MARKS = {"dot": "o", "ring": "o", "cross": "x", "square": "s", "diamond": "D"}
_DASHES = {"solid": "-", "dash": "--", "dot": ":", "dashdot": "-."}


def draw_png(figure: ThesisFigure) -> bytes:
    """Return the picture of a figure with panels; the same figure gives the same bytes.

    Raises:
        SlipwiseError: Matplotlib is not installed.
    """
    panels = figure.panels
    across = min(len(panels), 2 if len(panels) in (2, 4) else 3)
    down = math.ceil(len(panels) / across)
    width, height = SINGLE_SIZE if len(panels) == 1 else PANEL_SIZE
    canvas = drawing_part("figure").Figure(
        figsize=(width * across, height * down), dpi=DPI, layout="constrained"
    )
    for place, panel in enumerate(panels, start=1):
        _draw(canvas, (down, across, place), panel)
    return small_png(canvas, dpi=DPI, largest=LARGEST)


def _draw(canvas: Any, place: tuple[int, int, int], panel: Panel) -> None:
    axes: Any = canvas.add_subplot(*place, projection="3d" if panel.solid else None)
    axes.set_title(panel.title, fontsize=10)
    axes.set_xlabel(panel.x_label, fontsize=9)
    axes.set_ylabel(panel.y_label, fontsize=9)
    axes.tick_params(labelsize=8)
    bars = [series for series in panel.series if isinstance(series, Bars)]
    for series, colour in panel.coloured():
        if isinstance(series, Bars):
            _bars(axes, series, colour, (bars.index(series), len(bars)))
        else:
            _series(axes, series, colour, solid=panel.solid)
    if panel.x_names:
        _name_ticks(axes, panel.x_names)
    if panel.log_x:
        axes.set_xscale("log")
    if panel.log_y:
        axes.set_yscale("log")
    if panel.solid:
        axes.set_zlabel(panel.z_label, fontsize=9)
        axes.view_init(elev=24, azim=40)
        return
    if not any(isinstance(series, Heat) for series in panel.series):
        axes.grid(color="#e6eaef", linewidth=0.6)
        axes.set_axisbelow(True)
        if panel.equal_axes:
            axes.set_aspect("equal", adjustable="datalim")
    _legend(axes)


def _series(axes: Any, series: Series, colour: str, *, solid: bool) -> None:
    match series:
        case Line():
            axes.plot(
                series.x,
                series.y,
                _DASHES[series.dash],
                color=colour,
                linewidth=0.8 * series.width,
                alpha=series.opacity,
                label=series.label or None,
            )
        case Points():
            z = () if not solid else (np.zeros_like(series.x) if series.z is None else series.z,)
            hollow = {"markerfacecolor": "none"} if series.mark == "ring" else {}
            axes.plot(
                series.x,
                series.y,
                *z,
                linestyle="none",
                marker=_MARKS[series.mark],
                color=colour,
                markersize=0.75 * series.size,
                alpha=series.opacity,
                label=series.label or None,
                **hollow,
            )
        case ErrorBars():
            axes.errorbar(
                series.x,
                series.y,
                yerr=series.error,
                fmt=_MARKS[series.mark],
                color=colour,
                markersize=4,
                capsize=2,
                linewidth=0.9,
                linestyle="-" if series.joined else "none",
                label=series.label or None,
            )
        case Band():
            axes.fill_between(
                series.x,
                series.low,
                series.high,
                color=colour,
                alpha=0.22,
                linewidth=0,
                label=series.label or None,
            )
        case Surface():
            _surface(axes, series)
        case Heat():
            _heat(axes, series)


def _bars(axes: Any, bars: Bars, colour: str, place: tuple[int, int]) -> None:
    index, count = place
    width = 0.8 / count
    at = np.arange(len(bars.names)) + (index - (count - 1) / 2) * width
    axes.bar(at, bars.values, width, yerr=bars.error, color=colour, label=bars.label or None, capsize=2)
    _name_ticks(axes, bars.names)


def _name_ticks(axes: Any, names: tuple[str, ...]) -> None:
    """Name the places 0, 1, 2, ... of the x axis, aslant where the names are long."""
    aslant: dict[str, Any] = {"rotation": 25, "ha": "right"} if sum(map(len, names)) > MOST_LETTERS else {}
    axes.set_xticks(range(len(names)), names, fontsize=8, **aslant)


def _surface(axes: Any, surface: Surface) -> None:
    x, y = np.meshgrid(surface.x, surface.y)
    limit = float(np.abs(surface.z).max()) or 1.0
    axes.plot_surface(
        x, y, surface.z, cmap=_diverging(), vmin=-limit, vmax=limit, linewidth=0, rcount=25, ccount=25
    )
    if surface.std is not None:
        for sign in (1, -1):
            sheet = surface.z + sign * surface.std
            axes.plot_surface(x, y, sheet, color=BAND, alpha=0.25, linewidth=0, rcount=12, ccount=12)


def _heat(axes: Any, heat: Heat) -> None:
    image = axes.imshow(heat.values, cmap=_diverging(), vmin=-heat.limit, vmax=heat.limit, aspect="auto")
    axes.set_xticks(range(len(heat.columns)), heat.columns, rotation=60, ha="right", fontsize=7)
    axes.set_yticks(range(len(heat.rows)), heat.rows, fontsize=7)
    axes.figure.colorbar(image, ax=axes, shrink=0.9).ax.tick_params(labelsize=8)


def _diverging() -> Any:
    return drawing_part("colors").LinearSegmentedColormap.from_list("diverging", DIVERGING)


def _legend(axes: Any) -> None:
    handles, labels = axes.get_legend_handles_labels()
    first = dict(reversed(list(zip(labels, handles, strict=True))))
    if first:
        ordered = sorted(first, key=labels.index)
        axes.legend([first[name] for name in ordered], ordered, fontsize=7.5, framealpha=0.85)
