# SPDX-License-Identifier: Apache-2.0
"""The map of curvatures that a robot really holds as PNG, drawn by Matplotlib, which is loaded only here."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.errors import SlipwiseError
from slipwise.files import write_whole

if TYPE_CHECKING:
    from slipwise.planning import CurvatureMap

SIZE = (8.0, 5.0)  # inches
DPI = 150


def write_curvature_picture(path: Path, held: CurvatureMap, title: str) -> Path:
    """Draw the held curvature over commanded speed and curvature; return the path of the file.

    Raises:
        SlipwiseError: Matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    try:
        figures = importlib.import_module("matplotlib.figure")
    except ImportError as error:
        raise SlipwiseError(
            "pictures need Matplotlib, which is not installed",
            where=str(error),
            advice='pip install "slipwise[plot]", or leave the picture out by --no-picture',
        ) from error
    figure = figures.Figure(figsize=SIZE, layout="constrained")
    axes: Any = figure.add_subplot()
    widest = abs(held.told).max()
    drawn = axes.pcolormesh(held.told, held.speed, held.held, cmap="RdBu", vmin=-widest, vmax=widest)
    lines = axes.contour(held.told, held.speed, held.held, levels=9, colors="black", linewidths=0.7)
    axes.clabel(lines, fmt="%.2g")
    figure.colorbar(drawn, ax=axes, label="curvature that is held [1/m]")
    axes.set(xlabel="commanded curvature [1/m]", ylabel="commanded speed [m/s]", title=title)
    write_whole(
        path, lambda target: figure.savefig(target, format="png", dpi=DPI, metadata={"Software": None})
    )
    return path
