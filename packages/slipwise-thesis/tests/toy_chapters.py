# SPDX-License-Identifier: Apache-2.0
"""A chapter that somebody else might write: every kind of series and a table, made without simulation."""

from __future__ import annotations

import numpy as np

from slipwise.errors import SettingsError
from slipwise_thesis import (
    Band,
    Bars,
    Chapter,
    ChapterResult,
    ErrorBars,
    Fixture,
    Grid,
    Heat,
    Line,
    Panel,
    Points,
    Surface,
    ThesisFigure,
    figure_of_log,
    outline,
    paths_line,
)
from slipwise_thesis.chapters import Progress

X = np.linspace(0.0, 1.0, 11)
FLAT = Panel(
    "Lines",
    "x [m]",
    "y [m]",
    (
        paths_line([np.column_stack((X, X)), np.column_stack((X, -X))], label="measured"),
        Line(X, X**2, "curve", dash="dash"),
        Points(X, X, mark="ring", label="points"),
        ErrorBars(X, X, 0.1 * X, "bars", joined=True),
        Band(X, X - 0.1, X + 0.1, "band"),
        outline(np.array([0.5, 0.5]), np.array([[0.02, 0.01], [0.01, 0.03]]), label="1 sigma"),
    ),
    equal_axes=True,
)
LOGARITHMIC = Panel("Powers", "x", "y", (Line(X + 0.1, X + 0.1),), log_x=True, log_y=True)
NAMED = Panel("Named", "", "y [1]", (ErrorBars(np.arange(2.0), X[:2], X[:2]),), x_names=("one", "two"))
BARS = Panel(
    "Bars", "", "error [m]", (Bars(("a", "b"), X[:2], label="one"), Bars(("a", "b"), X[1:3], X[:2], "two"))
)
HEAT = Panel("Correlation", "", "", (Heat(np.array([[1.0, -0.5], [-0.5, 1.0]]), ("p", "q"), ("p", "q")),))


def solid(place: int = 0) -> Panel:
    """Return a panel with three axes."""
    z = np.outer(X, X) + 0.1 * place
    surface = Surface(X, X, z, 0.1 + 0.0 * z)
    return Panel("Surface", "V [m/s]", "ω [rad/s]", (surface, Points(X, X, X**2)), z_label="slip [m/s]")


def figure(key: str, *parts: Panel | Grid) -> ThesisFigure:
    """Return a figure of some parts."""
    return ThesisFigure(
        key,
        "Figure 9.9",
        f"Toy {key}",
        "What <b>is</b> shown.",
        "It agrees.",
        "It | differs.",
        "nowhere",
        parts,
    )


TABLE = Grid("A table", ("name", "error [m]"), (("a|b", "1"), ("c_d", "2")), note="A note.")


def toy_figures(fixture: Fixture, progress: Progress) -> list[ThesisFigure]:
    """Make a few figures, one of which needs a log."""
    progress("half", 0.5)
    missing = figure_of_log("figure-9-3", "Figure 9.3", "Of a log", lambda: _of_log(fixture))
    return [
        figure("figure-9-1", FLAT, BARS, HEAT, TABLE),
        figure("figure-9-2", solid(), LOGARITHMIC, NAMED),
        missing,
    ]


def _of_log(fixture: Fixture) -> ThesisFigure:
    fixture.real_log("nobody/has_this")
    raise AssertionError("the log is not there")


def failing_figures(fixture: Fixture, progress: Progress) -> list[ThesisFigure]:
    """Fail as a chapter may."""
    raise SettingsError("a chapter went wrong", where="toy", advice="mend it")


TOY = Chapter("toy", "A toy chapter", toy_figures)
FAILING = Chapter("failing", "A chapter that fails", failing_figures)


def toy_results() -> tuple[ChapterResult, ...]:
    """Return the toy chapter's figures."""
    figures = toy_figures(Fixture(), lambda _what, _share: None)
    return (ChapterResult(TOY.key, TOY.title, tuple(figures)),)
