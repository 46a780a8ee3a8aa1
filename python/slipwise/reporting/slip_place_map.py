# SPDX-License-Identifier: Apache-2.0
"""The map of slip by place: squares coloured by what a model did not expect, the larger the surer."""

from __future__ import annotations

from typing import Any

import numpy as np

from slipwise.calibration.predictions import Predictions
from slipwise.logs.log import Log, Poses
from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.markup import MINUS
from slipwise.reporting.palette import DIVERGING
from slipwise.reporting.slip_places import CHANNELS, SlipPlaces, slip_places
from slipwise.reporting.thinning import thinned

_PATH_POINTS = 400  # of the way driven, below the places
_HEIGHT = 250  # px
_SMALLEST, _LARGEST = 4.0, 13.0  # px, of a square


def place_maps(log: Log, part: Predictions | None, *, key: str, name: str = "") -> list[Figure]:
    """Return a map for each channel of the run that comes most often to where it was; empty if none does.

    Args:
        log: the drives.
        part: predictions of the learned method over a short horizon.
        key: unique on the page.
        name: of the log, for the heading.
    """
    if part is None:
        return []
    best: tuple[int, Poses, list[SlipPlaces]] | None = None
    for run, each in enumerate(log.runs):
        if len(each.poses) < 2 or np.ptp(each.poses.frame):
            continue  # poses of several frames have no common map
        found = [places for c in CHANNELS if (places := slip_places(each.poses, part, run, c)) is not None]
        again = sum(int((places.passes > 1).sum()) for places in found)
        if again and (best is None or again > sum(int((p.passes > 1).sum()) for p in best[2])):
            best = (run, each.poses, found)
    if best is None:
        return []
    title = f"{name}: " if name else ""
    return [_figure(best[1], places, key=key, title=title) for places in best[2]]


def _figure(poses: Poses, places: SlipPlaces, *, key: str, title: str) -> Figure:
    return Figure(
        key=f"{key}-{places.channel}",
        label=f"Map of {places.channel} slip that was not expected",
        heading=f"{title}{places.channel} slip not expected [%]",
        traces=[_path(poses), _squares(places)],
        layout={
            "margin": TOP_BAR_MARGIN,
            "xaxis": axis("x [m]", nticks=7),
            "yaxis": axis("y [m]", scaleanchor="x", scaleratio=1, nticks=7),
        },
        height=_HEIGHT,
        caption=_caption(places),
    )


def _path(poses: Poses) -> dict[str, Any]:
    keep = thinned(len(poses), _PATH_POINTS)
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(poses.x[keep]),
        "y": numbers(poses.y[keep]),
        "line": {"color": "#c3cad3", "width": 1},
        "hoverinfo": "skip",
    }


def _squares(places: SlipPlaces) -> dict[str, Any]:
    sure = np.quantile(places.std, 0.25) / np.maximum(places.std, 1e-9)
    limit = float(np.quantile(np.abs(places.percent), 0.9)) or 1.0
    return {
        "type": "scatter",
        "mode": "markers",
        "x": numbers(places.x),
        "y": numbers(places.y),
        "marker": {
            "symbol": "square",
            "size": numbers(_SMALLEST + (_LARGEST - _SMALLEST) * np.minimum(sure, 1.0)),
            "color": numbers(places.percent),
            "colorscale": DIVERGING,
            "cmin": -limit,
            "cmax": limit,
            "colorbar": top_colour_bar(),
            "line": {"color": "#566270", "width": 0.5},
        },
        "customdata": numbers(np.column_stack((places.std, places.windows, places.passes))),
        "hovertemplate": "%{marker.color:.2f} ± %{customdata[0]:.2f} %<br>%{customdata[1]} windows, "
        "passed %{customdata[2]} times<extra></extra>",
    }


def _caption(places: SlipPlaces) -> str:
    again = int((places.passes > 1).sum())
    text = f"Cells of {places.size:.2g} m, {again} of {len(places.x)} passed again."
    if places.agreement is None:
        return f"{text} Too few to say whether slip belongs to the place."
    agreement = f"{places.agreement:.2f}".replace("-", MINUS)
    return f"{text} First and later passes correlate by {agreement}: 1 where slip is the place's own."
