# SPDX-License-Identifier: Apache-2.0
"""The picture of a plan as PNG, drawn by Matplotlib, which is loaded only here."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from slipwise.errors import SlipwiseError
from slipwise.files import write_whole
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

WIDTH = 9.0  # inches
DPI = 150


def write_plan_picture(path: Path, plan: Plan) -> Path:
    """Draw the swept path on the map with its uncertainty; return the path of the file.

    Raises:
        SlipwiseError: Matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    try:
        figures = importlib.import_module("matplotlib.figure")
        patches = importlib.import_module("matplotlib.patches")
        colours = importlib.import_module("matplotlib.colors")
    except ImportError as error:
        raise SlipwiseError(
            "pictures need Matplotlib, which is not installed",
            where=str(error),
            advice='pip install "slipwise[plot]"',
        ) from error
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
    write_whole(
        path, lambda target: figure.savefig(target, format="png", dpi=DPI, metadata={"Software": None})
    )
    return path
