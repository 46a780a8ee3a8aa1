# SPDX-License-Identifier: Apache-2.0
"""The three regressions of chapter 5 on segments that they have not learned."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipwise import _core
from slipwise_thesis.chapter5_examples import SteadyExamples, all_examples, fitted
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, INK, MEASURED, Band, Dash, Line, Panel, Points, Series
from slipwise_thesis.surfaces import (
    BayesianSurface,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipSurface,
    SurfaceScore,
    score_surface,
)
from slipwise_thesis.thesis_figure import ThesisFigure

THESIS, ODD_EVEN = _core.named_basis("thesis-15"), _core.named_basis("odd-even-10")
SURFACES: dict[str, Callable[[], SlipSurface]] = {
    "least squares, terms of (5.1)": lambda: LeastSquaresSurface(THESIS),
    "the same, standard deviation by (5.6)": lambda: LeastSquaresSurface(THESIS, spread="thesis"),
    "least squares, odd-even-10": lambda: LeastSquaresSurface(ODD_EVEN),
    "Gaussian process": GaussianProcessSurface,
    "Bayesian, terms of (5.1)": lambda: BayesianSurface(THESIS),
    "Bayesian, odd-even-10": lambda: BayesianSurface(ODD_EVEN),
}
TERRAINS = 2  # sources that are simulated; the Husky comes after them
CUT: tuple[tuple[str, str, Dash], ...] = (
    ("least squares, odd-even-10", FITTED, "solid"),
    ("Gaussian process", BASELINE, "solid"),
    ("Bayesian, odd-even-10", MEASURED, "dash"),
)
COLUMNS = (
    "surface",
    "mean error forward, sideways [mm/s]",
    "angular [mrad/s]",
    "log score forward, sideways, angular",
    "inside 50, 90, 95 %",
)


def score_table(fixture: Fixture) -> ThesisFigure:
    """Make the table of held-out scores."""
    sources = all_examples(fixture)
    scores = [
        {name: score_surface(fitted(make, s.learned), s.held_out) for name, make in SURFACES.items()}
        for s in sources
    ]
    return ThesisFigure(
        key="table-5-scores",
        thesis="Not in the thesis",
        title="The three regressions on commands that they have not learned",
        shows="Every fifth command is left out of learning and predicted. Log score: mean logarithm of the "
        "predicted density at what was measured, more is better. The pictures cut the surfaces of the "
        "forward slip rate at one speed.",
        agrees=_agrees(sources, scores),
        differs="The thesis shows the surfaces and scores none. " + _differs(sources, scores),
        source="; ".join(source.source for source in sources),
        parts=(
            *(_grid(source, score) for source, score in zip(sources, scores, strict=True)),
            *(_cut(source) for source in sources),
        ),
    )


def _grid(source: SteadyExamples, scores: dict[str, SurfaceScore]) -> Grid:
    rows = [_row(name, score) for name, score in scores.items()]
    baseline = 1e3 * np.abs(source.held_out.slip).mean(axis=0)
    rows.insert(0, ("no slip", f"{baseline[0]:.1f}, {baseline[1]:.1f}", f"{baseline[2]:.1f}", "–", "–"))
    note = f"{len(source.learned)} segments learned, {len(source.held_out)} held out."
    return Grid(source.source, COLUMNS, tuple(rows), note)


def _row(name: str, score: SurfaceScore) -> tuple[str, ...]:
    error = 1e3 * score.error
    inside = 100.0 * score.coverage.mean(axis=1)
    log_scores = ", ".join(f"{value:.2f}" if np.isfinite(value) else "–" for value in score.log_score)
    return (
        name,
        f"{error[0]:.1f}, {error[1]:.1f}",
        f"{error[2]:.1f}",
        log_scores,
        ", ".join(f"{value:.0f}" for value in inside),
    )


def _agrees(sources: list[SteadyExamples], scores: list[dict[str, SurfaceScore]]) -> str:
    """How much alike the three are, with the same terms where they have any."""
    names = ("least squares, odd-even-10", "Gaussian process", "Bayesian, odd-even-10")
    said = []
    for source, score in zip(sources, scores, strict=True):
        baseline = float(np.abs(source.held_out.slip).mean(axis=0)[2])
        least, process, bayesian = (float(score[name].error[2]) for name in names)
        said.append(
            f"{1e3 * least:.1f}, {1e3 * process:.1f} and {1e3 * bayesian:.1f} mrad/s where no slip misses by "
            f"{1e3 * baseline:.0f} ({source.source.split(',')[0]})"
        )
    return f"All three give similar results: held-out angular errors of {'; '.join(said)}."


def _differs(sources: list[SteadyExamples], scores: list[dict[str, SurfaceScore]]) -> str:
    """What the terms of (5.1) cost."""
    names = ("least squares, terms of (5.1)", "least squares, odd-even-10")
    sideways = [f"{1e3 * scores[0][name].error[1]:.1f} mm/s" for name in names]
    turns = [f"{1e3 * scores[-1][name].error[2]:.1f} mrad/s" for name in names]
    in_place = (
        f" The Husky also turns in place, where curvature says nothing: they miss by {turns[0]} in the yaw "
        f"rate, those of odd-even-10 by {turns[1]}."
    )
    return (
        f"The terms of (5.1) have no V ω: sideways they miss by {sideways[0]} where those of odd-even-10 "
        f"miss by {sideways[1]} on tyre-force terrain. A dash for a log score means that the standard "
        "deviation of (5.6) is negative somewhere." + in_place * (len(sources) > TERRAINS)
    )


def _cut(source: SteadyExamples) -> Panel:
    """The forward slip rate, in which the three differ the most, over yaw rate at the median speed."""
    v = float(np.median(np.abs(source.whole.v)))
    yaw_rate = np.linspace(source.whole.omega.min(), source.whole.omega.max(), 61)
    series: list[Series] = []
    for label, colour, dash in CUT:
        prediction = fitted(SURFACES[label], source.learned).predict(np.full_like(yaw_rate, v), yaw_rate)
        mean, std = prediction.mean[:, 0], prediction.std[:, 0]
        series += [
            Band(yaw_rate, mean - std, mean + std, colour=colour),
            Line(yaw_rate, mean, label, colour, dash),
        ]
    near = np.abs(source.held_out.v - v) < 0.3
    held = source.held_out[near]
    name = source.source.split(",")[0].removeprefix("simulated Land Tamer on ")
    series.append(
        Points(held.omega, held.slip[:, 0], label="held out, within 0.3 m/s", colour=INK, mark="ring")
    )
    return Panel(
        f"{name}, V = {v:.2g} m/s",
        "ω [rad/s]",
        "forward slip rate [m/s]",
        tuple(series),
    )
