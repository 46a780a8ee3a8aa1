# SPDX-License-Identifier: Apache-2.0
"""The learned slip over speed and yaw rate, and which of both the log holds for how long."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.held import held_for
from slipwise.models.model import Model
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.markup import grid, missing
from slipwise.reporting.palette import SEQUENTIAL
from slipwise.reporting.slip_figures import CHANNELS, MAP_HEIGHT, NODES, SlipGrid, contour_map

Floats = NDArray[np.float64]

_BINS = 32
_SHORTEST = 1e-3  # s; shorter is drawn like this


class SurfacesSection:
    """What slip did the model learn, and where?"""

    title = "Learned slip, and the speeds and yaw rates driven"
    explanation = (
        "Rates added to the motion on level terrain: red takes away, blue adds. Not known outside the dashed "
        "box."
    )

    def html(self, contents: Contents) -> str:
        """Return a map for each channel of slip, and the histogram of inputs."""
        driven = coverage_figure(contents)
        name = "wheel speeds" if contents.evaluation.input == "wheel" else "commands"
        absent = [] if driven else [f"The log has no {name}, so there is no plane of inputs to cover."]
        maps, sentences = _slip(contents.calibration.model)
        shown = [*maps, *([driven] if driven else [])]
        drawn = grid(figure.html() for figure in shown) if shown else ""
        return drawn + "".join(missing(text) for text in (*sentences, *absent))


def _slip(model: Model) -> tuple[list[Figure], list[str]]:
    """Return maps of the channels that have slip terms, and sentences about the others."""
    if not model.motion.slip_size:
        return [], ["The model has no slip terms, so there are no maps of slip."]
    speed, yaw_rate = model.content.range.speed, model.content.range.yaw_rate
    if speed[1] - speed[0] < 1e-6 or yaw_rate[1] - yaw_rate[0] < 1e-6:
        return [], ["The log holds one speed or one yaw rate only, so slip cannot be drawn over both."]
    grid, basis = _grid(model), model.motion.basis
    terms = (basis.lon, basis.lat, basis.ang)
    drawn = [channel for channel in range(len(CHANNELS)) if terms[channel]]
    names = [name for (name, _, _), given in zip(CHANNELS, terms, strict=True) if not given]
    return (
        [contour_map(grid, channel) for channel in drawn],
        [f"The model has no terms for {name} slip." for name in names],
    )


def _grid(model: Model) -> SlipGrid:
    basis, size = model.motion.basis, model.motion.slip_size
    alpha = np.ascontiguousarray(model.mean[:size])
    covariance = np.asfortranarray(model.covariance[:size, :size])
    span = model.content.range
    speed = np.linspace(span.speed[0], span.speed[1], NODES)
    yaw_rate = np.linspace(span.yaw_rate[0], span.yaw_rate[1], NODES)
    mean = np.empty((3, NODES, NODES))
    std = np.empty((3, NODES, NODES))
    for row, omega in enumerate(yaw_rate.tolist()):
        for column, v in enumerate(speed.tolist()):
            state = _core.SlipState(v, omega, 0.0, 0.0)
            mean[:, row, column] = _core.slip_rate(basis, alpha, state)
            variance = np.diag(_core.slip_rate_covariance(basis, covariance, state))
            std[:, row, column] = np.sqrt(np.maximum(variance, 0.0))
    return SlipGrid(speed, yaw_rate, mean, std)


def coverage_figure(contents: Contents) -> Figure | None:
    """Return the histogram over the plane of inputs, None where the log has no such input."""
    used = [inputs for run in contents.log.runs if (inputs := contents.inputs(run)) is not None]
    if not used:
        return None
    v, omega = (np.concatenate([getattr(part, name) for part in used]) for name in ("v", "omega"))
    held = np.concatenate([held_for(part, contents.unknown_after) for part in used])
    seconds, v_edges, omega_edges = np.histogram2d(
        v, omega, bins=_BINS, range=(_range(v), _range(omega)), weights=held
    )
    heatmap = {
        "type": "heatmap",
        "x": numbers(0.5 * (v_edges[:-1] + v_edges[1:])),
        "y": numbers(0.5 * (omega_edges[:-1] + omega_edges[1:])),
        "z": numbers(np.where(seconds > 0.0, np.log10(np.maximum(seconds, _SHORTEST)), np.nan).T),
        "customdata": numbers(seconds.T),
        "colorscale": SEQUENTIAL,
        "reversescale": True,
        "colorbar": _colour_bar(seconds),
        "hoverongaps": False,
        "hovertemplate": "V %{x:.2f} m/s, ω %{y:.2f} rad/s<br>%{customdata:.1f} s<extra></extra>",
    }
    return Figure(
        key="coverage",
        heading="Time driven [s]",
        label="Time spent at each speed and yaw rate",
        traces=[heatmap],
        layout={
            "margin": TOP_BAR_MARGIN,
            "xaxis": axis("speed V [m/s]"),
            "yaxis": axis("yaw rate ω [rad/s]"),
            "shapes": [_box(contents)],
        },
        height=MAP_HEIGHT,
        caption=f"{held.sum():.0f} s in all; dashed: range of the model",
    )


def _range(values: Floats) -> tuple[float, float]:
    """The range of a histogram's axis: that of the values, a little wider."""
    low, high = float(values.min()), float(values.max())
    margin = 0.03 * (high - low) or 0.1
    return low - margin, high + margin


def _colour_bar(seconds: Floats) -> dict[str, Any]:
    """Round times between the shortest and the longest: decades where these are far apart, else 1, 2, 5."""
    driven = np.maximum(seconds[seconds > 0.0], _SHORTEST)
    low, high = (float(driven.min()), float(driven.max())) if len(driven) else (1.0, 1.0)
    steps = (1.0,) if high > 100.0 * low else (1.0, 2.0, 5.0)
    times = np.array([step * 10.0**decade for decade in range(-3, 8) for step in steps])
    times = times[(times >= 0.999 * low) & (times <= 1.001 * high)]
    shown = times if len(times) > 1 else np.array([low, high])
    texts = [f"{time:.2g}" for time in shown.tolist()]
    return top_colour_bar(tickvals=numbers(np.log10(shown)), ticktext=texts)


def _box(contents: Contents) -> dict[str, Any]:
    span = contents.calibration.model.content.range
    return {
        "type": "rect",
        "x0": span.speed[0],
        "x1": span.speed[1],
        "y0": span.yaw_rate[0],
        "y1": span.yaw_rate[1],
        "line": {"color": "#1b2430", "width": 1.5, "dash": "dash"},
    }
