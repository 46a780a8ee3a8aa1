# SPDX-License-Identifier: Apache-2.0
"""The map of curvatures that a robot really holds as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.reporting.png_picture import drawing_part, write_png

if TYPE_CHECKING:
    from slipwise.planning import CurvatureMap

SIZE = (8.0, 5.0)  # inches


def write_curvature_picture(path: Path, held: CurvatureMap, title: str) -> Path:
    """Draw the held curvature over commanded speed and curvature; return the path of the file.

    Raises:
        SlipwiseError: Matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    figure = drawing_part("figure").Figure(figsize=SIZE, layout="constrained")
    axes: Any = figure.add_subplot()
    widest = abs(held.commanded).max()
    drawn = axes.pcolormesh(held.commanded, held.speed, held.held, cmap="RdBu", vmin=-widest, vmax=widest)
    lines = axes.contour(held.commanded, held.speed, held.held, levels=9, colors="black", linewidths=0.7)
    axes.clabel(lines, fmt="%.2g")
    figure.colorbar(drawn, ax=axes, label="curvature that is held [1/m]")
    axes.set(xlabel="commanded curvature [1/m]", ylabel="commanded speed [m/s]", title=title)
    return write_png(path, figure)
