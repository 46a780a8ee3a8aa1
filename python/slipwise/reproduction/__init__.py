# SPDX-License-Identifier: Apache-2.0
"""The thesis's figures and tables, made again from simulated drives and real logs."""

from slipwise.reproduction.bench import FULL, SMALL, Bench, BenchSize, MissingLogError
from slipwise.reproduction.exhibit import Exhibit, exhibit_of_log
from slipwise.reproduction.grid import Grid
from slipwise.reproduction.panel import (
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
from slipwise.reproduction.reproduce import CHAPTERS, Chapter, ChapterResult, reproduce
from slipwise.reproduction.write import write_reproduction

__all__ = [
    "CHAPTERS",
    "FULL",
    "SMALL",
    "Band",
    "Bars",
    "Bench",
    "BenchSize",
    "Chapter",
    "ChapterResult",
    "ErrorBars",
    "Exhibit",
    "Grid",
    "Heat",
    "Line",
    "MissingLogError",
    "Panel",
    "Points",
    "Surface",
    "exhibit_of_log",
    "outline",
    "paths_line",
    "reproduce",
    "write_reproduction",
]
