# SPDX-License-Identifier: Apache-2.0
"""Pictures of slip rates over speed and yaw rate: surfaces that can be turned, and contour maps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.palette import BAND, DIVERGING
from slipwise.surfaces import SlipExamples, SlipSurface

NODES = 25  # along each axis of a surface
MAP_HEIGHT = 240  # px
CHANNELS = (
    ("forward", "forward slip rate [m/s]", "m/s"),
    ("sideways", "slip rate to the left [m/s]", "m/s"),
    ("angular", "slip rate of the yaw [rad/s]", "rad/s"),
)
_HOVER = "V %{x:.2f} m/s, ω %{y:.2f} rad/s<br>%{z:.3g} ± %{customdata:.2g}"
_SPEED, _YAW_RATE = "speed V [m/s]", "yaw rate ω [rad/s]"
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SlipGrid:
    """Slip rates on a grid of speeds [S] and yaw rates [W]: mean and standard deviation, [3, W, S] each."""

    speed: Floats  # m/s
    yaw_rate: Floats  # rad/s
    mean: Floats
    std: Floats


def surface_grid(surface: SlipSurface, examples: SlipExamples) -> SlipGrid:
    """Evaluate a fitted surface over the speeds and yaw rates of examples."""
    speed = np.linspace(examples.v.min(), examples.v.max(), NODES)
    yaw_rate = np.linspace(examples.omega.min(), examples.omega.max(), NODES)
    v, omega = np.meshgrid(speed, yaw_rate)
    prediction = surface.predict(v.ravel(), omega.ravel())
    shape = (3, NODES, NODES)
    return SlipGrid(speed, yaw_rate, prediction.mean.T.reshape(shape), prediction.std.T.reshape(shape))


def surface_figures(surface: SlipSurface, examples: SlipExamples) -> list[Figure]:
    """Return a fitted surface with its examples, to be turned, for each channel (thesis figures 5.1-5.3)."""
    grid = surface_grid(surface, examples)
    return [turnable_surface(grid, channel, examples) for channel in range(len(CHANNELS))]


def _limit(grid: SlipGrid, channel: int) -> float:
    """The largest slip: the colours reach from minus this to this, so that white is none."""
    return float(np.abs(grid.mean[channel]).max()) or 1.0


def turnable_surface(grid: SlipGrid, channel: int, examples: SlipExamples | None = None) -> Figure:
    """Return one channel's mean between sheets one standard deviation away, with the examples as points."""
    name, title, unit = CHANNELS[channel]
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
    sheets = [surface, {**sheet, "z": numbers(mean + std)}, {**sheet, "z": numbers(mean - std)}]
    return Figure(
        key=f"surface-{name}",
        label=f"Surface of the {title} over speed and yaw rate",
        heading=f"{name.capitalize()} slip rate [{unit}]",
        traces=[*sheets, *_points(examples, channel)],
        layout={"margin": {"l": 0, "r": 0, "t": 0, "b": 0}, "scene": _scene()},
        height=300,
    )


def _points(examples: SlipExamples | None, channel: int) -> list[dict[str, Any]]:
    if examples is None:
        return []
    return [
        {
            "type": "scatter3d",
            "mode": "markers",
            "x": numbers(examples.v),
            "y": numbers(examples.omega),
            "z": numbers(examples.slip[:, channel]),
            "marker": {"size": 2.5, "color": "#1b2430"},
            "hovertemplate": "V %{x:.2f} m/s, ω %{y:.2f} rad/s<br>%{z:.3g}<extra></extra>",
        }
    ]


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


def contour_map(grid: SlipGrid, channel: int) -> Figure:
    """Return one channel's mean as a map with contours."""
    name, title, unit = CHANNELS[channel]
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
        height=MAP_HEIGHT,
    )
