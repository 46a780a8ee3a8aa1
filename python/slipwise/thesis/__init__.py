# SPDX-License-Identifier: Apache-2.0
"""The thesis's figures and tables, made again from simulated drives and real logs."""

from slipwise.thesis.fixture import FULL, SMALL, Fixture, FixtureSize, MissingLogError
from slipwise.thesis.grid import Grid
from slipwise.thesis.panel import (
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
from slipwise.thesis.reproduce import CHAPTERS, Chapter, ChapterResult, reproduce
from slipwise.thesis.thesis_figure import ThesisFigure, figure_of_log
from slipwise.thesis.write import write_reproduction

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
