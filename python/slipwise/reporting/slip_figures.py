# SPDX-License-Identifier: Apache-2.0
"""Contour maps of slip rates over speed and yaw rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.palette import DIVERGING

NODES = 17  # along each axis of a map
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


def _limit(grid: SlipGrid, channel: int) -> float:
    """The largest slip: the colours reach from minus this to this, so that white is none."""
    return float(np.abs(grid.mean[channel]).max()) or 1.0


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
