# SPDX-License-Identifier: Apache-2.0
"""The thesis's figures and tables, made again from simulated drives and real logs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.lazy_names import lazy_names

if TYPE_CHECKING:
    from slipwise_thesis.chapters import CHAPTERS, Chapter, ChapterResult, reproduce
    from slipwise_thesis.fixture import FULL, SMALL, Fixture, FixtureSize, MissingLogError
    from slipwise_thesis.grid import Grid
    from slipwise_thesis.panel import (
        Band,
        Bars,
        ErrorBars,
        Heat,
        Line,
        Panel,
        Points,
        Surface,
        outline,
        paths_line,
    )
    from slipwise_thesis.thesis_figure import ThesisFigure, figure_of_log
    from slipwise_thesis.write import write_reproduction

__all__ = [
    "CHAPTERS",
    "FULL",
    "SMALL",
    "Band",
    "Bars",
    "Chapter",
    "ChapterResult",
    "ErrorBars",
    "Fixture",
    "FixtureSize",
    "Grid",
    "Heat",
    "Line",
    "MissingLogError",
    "Panel",
    "Points",
    "Surface",
    "ThesisFigure",
    "figure_of_log",
    "outline",
    "paths_line",
    "reproduce",
    "write_reproduction",
]

#: Where each public name lives.
_HOMES = {
    "slipwise_thesis.fixture": (
        "FULL",
        "SMALL",
        "Fixture",
        "FixtureSize",
        "MissingLogError",
    ),
    "slipwise_thesis.grid": ("Grid",),
    "slipwise_thesis.panel": (
        "Band",
        "Bars",
        "ErrorBars",
        "Heat",
        "Line",
        "Panel",
        "Points",
        "Surface",
        "outline",
        "paths_line",
    ),
    "slipwise_thesis.chapters": (
        "CHAPTERS",
        "Chapter",
        "ChapterResult",
        "reproduce",
    ),
    "slipwise_thesis.thesis_figure": (
        "ThesisFigure",
        "figure_of_log",
    ),
    "slipwise_thesis.write": ("write_reproduction",),
}
__getattr__ = lazy_names(__name__, _HOMES)
