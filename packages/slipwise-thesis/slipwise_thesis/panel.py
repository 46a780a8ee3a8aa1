# SPDX-License-Identifier: Apache-2.0
"""A plot without a plotting library: both backends draw the same description."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from slipwise.ellipse import outline_of

Floats = NDArray[np.float64]
Dash = Literal["solid", "dash", "dot", "dashdot"]
Mark = Literal["dot", "ring", "cross", "square", "diamond"]

# The thesis's colours, distinct to the colour-blind (Okabe and Ito 2008).
MEASURED = "#009e73"  # green
IDEAL = "#cc79a7"  # magenta
FITTED = "#0072b2"  # blue
BASELINE = "#d55e00"  # red
INK = "#1b2430"
GREY = "#8a94a0"
COLOURS = (FITTED, BASELINE, MEASURED, IDEAL, "#56b4e9", "#b8860b", "#7a4fa3", INK, GREY)


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points; a value that is not finite interrupts it."""

    x: Floats  # [N]
    y: Floats  # [N]
    label: str = ""  # in the legend; lines of the same label share an entry
    colour: str = ""  # "#rrggbb"; empty: the next of COLOURS
    dash: Dash = "solid"
    width: float = 1.6  # px
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class Points:
    """Separate points; `z` only beside a Surface."""

    x: Floats  # [N]
    y: Floats  # [N]
    z: Floats | None = None  # [N]
    label: str = ""
    colour: str = ""
    mark: Mark = "dot"
    size: float = 4.0  # px
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class ErrorBars:
    """Points with a bar of `error` to either side in y."""

    x: Floats  # [N]
    y: Floats  # [N]
    error: Floats  # [N]
    label: str = ""
    colour: str = ""
    mark: Mark = "dot"
    joined: bool = False  # by a thin line


@dataclass(frozen=True, eq=False)
class Band:
    """The area between two lines."""

    x: Floats  # [N]
    low: Floats  # [N]
    high: Floats  # [N]
    label: str = ""
    colour: str = ""


@dataclass(frozen=True, eq=False)
class Bars:
    """A bar per name; several Bars of the same names stand side by side."""

    names: tuple[str, ...]  # [N]
    values: Floats  # [N]
    error: Floats | None = None  # [N]
    label: str = ""
    colour: str = ""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface over a grid, between sheets one standard deviation away where `std` is given."""

    x: Floats  # [N]
    y: Floats  # [M]
    z: Floats  # [M, N]
    std: Floats | None = None  # [M, N]
    label: str = ""


@dataclass(frozen=True, eq=False)
class Heat:
    """A matrix as colours from -limit (red) over 0 (white) to limit (blue), its first row on top."""

    values: Floats  # [M, N]
    rows: tuple[str, ...]  # [M]
    columns: tuple[str, ...]  # [N]
    limit: float = 1.0


Series = Line | Points | ErrorBars | Band | Bars | Surface | Heat


@dataclass(frozen=True, eq=False)
class Panel:
    """One plot. Titles of axes carry units."""

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    z_label: str = ""
    x_names: tuple[str, ...] = ()  # instead of the numbers 0, 1, 2, ... at the x axis
    equal_axes: bool = False
    log_x: bool = False
    log_y: bool = False

    @property
    def solid(self) -> bool:
        """Whether the plot has three axes."""
        return any(isinstance(series, Surface) for series in self.series)

    def coloured(self) -> list[tuple[Series, str]]:
        """Return every series with its colour: its own, or the next of COLOURS."""
        found, place = [], 0
        for series in self.series:
            own = "" if isinstance(series, Surface | Heat) else series.colour
            found.append((series, own or COLOURS[place % len(COLOURS)]))
            place += not own
        return found


def paths_line(paths: Sequence[Floats], *, label: str = "", colour: str = MEASURED) -> Line:
    """Return many paths [K, 2 or more] as one thin line with gaps, drawn by their first two columns."""
    gap = np.full((1, 2), np.nan)
    joined = np.concatenate([part for path in paths for part in (np.asarray(path)[:, :2], gap)])
    return Line(joined[:, 0], joined[:, 1], label, colour, width=0.7, opacity=0.6)


def outline(centre: Floats, covariance: Floats, *, label: str = "", colour: str = INK) -> Line:
    """Return the 1-sigma ellipse of x, y [m, m^2] as a closed line.

    Raises:
        ValueError: the covariance [2, 2] is none.
    """
    points = outline_of(centre, covariance, 1.0)
    if points is None:
        raise ValueError("this is no covariance: an ellipse needs finite, non-negative variances")
    return Line(points[:, 0], points[:, 1], label, colour)
