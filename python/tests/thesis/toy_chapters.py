# SPDX-License-Identifier: Apache-2.0
"""A chapter that somebody else might write: every kind of series and a table, made without simulation."""

from __future__ import annotations

import numpy as np

from slipwise.errors import SettingsError
from slipwise.thesis import (
    Band,
    Bars,
    Bench,
    Chapter,
    ChapterResult,
    ErrorBars,
    Exhibit,
    Grid,
    Heat,
    Line,
    Panel,
    Points,
    Surface,
    exhibit_of_log,
    outline,
    paths_line,
)
from slipwise.thesis.reproduce import Progress

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


def exhibit(key: str, *parts: Panel | Grid) -> Exhibit:
    """Return an exhibit of some parts."""
    return Exhibit(
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


def toy_exhibits(bench: Bench, progress: Progress) -> list[Exhibit]:
    """Make a few exhibits, one of which needs a log."""
    progress("half", 0.5)
    missing = exhibit_of_log("figure-9-3", "Figure 9.3", "Of a log", lambda: _of_log(bench))
    return [
        exhibit("figure-9-1", FLAT, BARS, HEAT, TABLE),
        exhibit("figure-9-2", solid(), LOGARITHMIC, NAMED),
        missing,
    ]


def _of_log(bench: Bench) -> Exhibit:
    bench.real_log("nobody/has_this")
    raise AssertionError("the log is not there")


def failing_exhibits(bench: Bench, progress: Progress) -> list[Exhibit]:
    """Fail as a chapter may."""
    raise SettingsError("a chapter went wrong", where="toy", advice="mend it")


TOY = Chapter("toy", "A toy chapter", toy_exhibits)
FAILING = Chapter("failing", "A chapter that fails", failing_exhibits)


def toy_results() -> tuple[ChapterResult, ...]:
    """Return the toy chapter's exhibits."""
    exhibits = toy_exhibits(Bench(), lambda _what, _share: None)
    return (ChapterResult(TOY.key, TOY.title, tuple(exhibits)),)
