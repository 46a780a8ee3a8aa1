# SPDX-License-Identifier: Apache-2.0
"""The learned slip over speed and yaw rate, as surfaces and as maps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.models.model import Model
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.markup import legend, missing, paragraph
from slipwise.reporting.palette import BAND, DIVERGING

_NODES = 25  # along each axis of a surface
_CHANNELS = (
    ("forward", "forward slip rate [m/s]", "m/s"),
    ("sideways", "slip rate to the left [m/s]", "m/s"),
    ("angular", "slip rate of the yaw [rad/s]", "rad/s"),
)
_HOVER = "V %{x:.2f} m/s, ω %{y:.2f} rad/s<br>%{z:.3g} ± %{customdata:.2g}"
_SPEED, _YAW_RATE = "speed V [m/s]", "yaw rate ω [rad/s]"
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Grid:
    """Slip rates on a grid of speeds [S] and yaw rates [W]: mean and standard deviation, [3, W, S] each."""

    speed: Floats  # m/s
    yaw_rate: Floats  # rad/s
    mean: Floats
    std: Floats


class SurfacesSection:
    """What slip did the model learn?"""

    title = "Learned slip"
    explanation = (
        "The slip rates that the model adds to the commanded motion on level ground, within the speeds and "
        "yaw rates of the log; red takes away, blue adds, and the grey sheets lie one standard deviation "
        "above and below."
    )

    def html(self, contents: Contents) -> str:
        """Return a surface to be turned and a contour map for each channel of slip."""
        model = contents.calibration.model
        if not model.motion.slip_size:
            return missing("The model has no slip terms, so there are no slip surfaces.")
        speed, yaw_rate = model.content.range.speed, model.content.range.yaw_rate
        if speed[1] - speed[0] < 1e-6 or yaw_rate[1] - yaw_rate[0] < 1e-6:
            return missing("The log holds one speed or one yaw rate only, so slip cannot be drawn over both.")
        grid = _grid(model)
        basis = model.motion.basis
        terms = (basis.lon, basis.lat, basis.ang)
        drawn = [channel for channel in range(len(_CHANNELS)) if terms[channel]]
        surfaces = "".join(_surface(grid, channel).html() for channel in drawn)
        maps = "".join(_contours(grid, channel).html() for channel in drawn)
        names = [name for (name, _, _), given in zip(_CHANNELS, terms, strict=True) if not given]
        absent = (missing(f"The model has no terms for {name} slip.") for name in names)
        keys = (("± 1 sigma", "#7b8794", "area"),)
        return (
            paragraph("Drag to turn a surface, pinch or use the wheel to zoom.", kind="explanation")
            + legend(keys)
            + f'<div class="grid">{surfaces}</div><div class="grid">{maps}</div>'
            + "".join(absent)
        )


def _grid(model: Model) -> _Grid:
    basis, size = model.motion.basis, model.motion.slip_size
    alpha = np.ascontiguousarray(model.mean[:size])
    covariance = np.asfortranarray(model.covariance[:size, :size])
    span = model.content.range
    speed = np.linspace(span.speed[0], span.speed[1], _NODES)
    yaw_rate = np.linspace(span.yaw_rate[0], span.yaw_rate[1], _NODES)
    mean = np.empty((3, _NODES, _NODES))
    std = np.empty((3, _NODES, _NODES))
    for row, omega in enumerate(yaw_rate.tolist()):
        for column, v in enumerate(speed.tolist()):
            state = _core.SlipState(v, omega, 0.0, 0.0)
            mean[:, row, column] = _core.slip_rate(basis, alpha, state)
            variance = np.diag(_core.slip_rate_covariance(basis, covariance, state))
            std[:, row, column] = np.sqrt(np.maximum(variance, 0.0))
    return _Grid(speed, yaw_rate, mean, std)


def _limit(grid: _Grid, channel: int) -> float:
    """The largest slip: the colours reach from minus this to this, so that white is none."""
    return float(np.abs(grid.mean[channel]).max()) or 1.0


def _surface(grid: _Grid, channel: int) -> Figure:
    name, title, unit = _CHANNELS[channel]
    limit = _limit(grid, channel)
    mean, std = grid.mean[channel], grid.std[channel]
    plane = {"type": "surface", "x": numbers(grid.speed), "y": numbers(grid.yaw_rate), "showscale": False}
    sheet = {**plane, "opacity": 0.28, "colorscale": [[0, BAND], [1, BAND]], "hoverinfo": "skip"}
    surface = {
        **plane,
        "z": numbers(mean),
        "colorscale": DIVERGING,
        "cmin": -limit,
        "cmax": limit,
        "customdata": numbers(std),
        "hovertemplate": _HOVER + f" {unit}<extra></extra>",
    }
    return Figure(
        key=f"surface-{name}",
        label=f"Surface of the {title} over speed and yaw rate",
        heading=f"{name.capitalize()} slip rate [{unit}]",
        traces=[surface, {**sheet, "z": numbers(mean + std)}, {**sheet, "z": numbers(mean - std)}],
        layout={"margin": {"l": 0, "r": 0, "t": 0, "b": 0}, "scene": _scene()},
        height=300,
    )


def _scene() -> dict[str, Any]:
    small = {"tickfont": {"size": 10}, "nticks": 5, "gridcolor": "#d5dbe1", "backgroundcolor": "#f7f9fa"}

    def scene_axis(text: str) -> dict[str, Any]:
        return {**small, "showbackground": True, "title": {"text": text, "font": {"size": 12}}}

    return {
        "xaxis": scene_axis("V [m/s]"),
        "yaxis": scene_axis("ω [rad/s]"),
        "zaxis": scene_axis(""),
        "aspectmode": "cube",
        "camera": {"eye": {"x": 1.6, "y": 1.6, "z": 0.9}, "center": {"x": 0, "y": 0, "z": -0.1}},
    }


def _contours(grid: _Grid, channel: int) -> Figure:
    name, title, unit = _CHANNELS[channel]
    limit = _limit(grid, channel)
    contour = {
        "type": "contour",
        "x": numbers(grid.speed),
        "y": numbers(grid.yaw_rate),
        "z": numbers(grid.mean[channel]),
        "customdata": numbers(grid.std[channel]),
        "colorscale": DIVERGING,
        "zmin": -limit,
        "zmax": limit,
        "contours": {"showlabels": True, "labelfont": {"size": 11, "color": "#1b2430"}},
        "line": {"width": 0.7, "color": "#566270"},
        "colorbar": top_colour_bar(),
        "hovertemplate": _HOVER + f" {unit}<extra></extra>",
    }
    return Figure(
        key=f"contours-{name}",
        label=f"Contours of the {title} over speed and yaw rate",
        heading=title[0].upper() + title[1:],
        traces=[contour],
        layout={"margin": TOP_BAR_MARGIN, "xaxis": axis(_SPEED), "yaxis": axis(_YAW_RATE)},
        height=320,
    )
