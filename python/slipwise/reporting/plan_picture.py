# SPDX-License-Identifier: Apache-2.0
"""The picture of a plan as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from slipwise.reporting.plan_drawing import (
    GOAL,
    OCCUPIED,
    PATH,
    SPREAD,
    SWEPT,
    Plan,
    ellipses,
    extent,
    outline,
)
from slipwise.reporting.png_picture import drawing_part, write_png

WIDTH = 9.0  # inches


def write_plan_picture(path: Path, plan: Plan) -> Path:
    """Draw the swept path on the map with its uncertainty; return the path of the file.

    Raises:
        SlipwiseError: Matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    figures, patches, colours = map(drawing_part, ("figure", "patches", "colors"))
    left, right, bottom, top = extent(plan)
    height = WIDTH * min(max((top - bottom) / (right - left), 0.3), 1.5)
    figure = figures.Figure(figsize=(WIDTH, height + 0.6), layout="constrained")
    axes: Any = figure.add_subplot(aspect="equal", xlim=(left, right), ylim=(bottom, top))
    cells = colours.ListedColormap(["white", OCCUPIED])
    place = {"origin": "lower", "extent": (left, right, bottom, top), "interpolation": "nearest"}
    axes.imshow(plan.grid.occupied, cmap=cells, vmin=0, vmax=1, **place)
    for curve in outline(plan):
        axes.add_patch(patches.Polygon(curve, facecolor=SWEPT, edgecolor="none", alpha=0.35))
    for curve in ellipses(plan):
        axes.plot(curve[:, 0], curve[:, 1], color=SPREAD, linewidth=1.0)
    poses = plan.route.predicted
    axes.plot(poses[:, 0], poses[:, 1], color=PATH, linewidth=1.8)
    axes.plot(*plan.goal[:2], marker="x", color=GOAL, markersize=9, markeredgewidth=2.2)
    axes.set(xlabel="x [m]", ylabel="y [m]", title=plan.title)
    return write_png(path, figure)
