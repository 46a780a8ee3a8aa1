# SPDX-License-Identifier: Apache-2.0
"""Chapters 2 to 4 on small drives: all figures are there, and hold what they claim."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from slipwise_thesis import SMALL, ErrorBars, Fixture, Points, ThesisFigure
from slipwise_thesis.chapter2 import chapter2_figures
from slipwise_thesis.chapter3 import chapter3_figures
from slipwise_thesis.chapter4 import chapter4_figures
from slipwise_thesis.chapter4_husky import husky_curves, husky_rates

pytestmark = pytest.mark.slow

pytest.importorskip("mujoco")

Figures = dict[str, ThesisFigure]


@pytest.fixture(scope="module")
def figures() -> Figures:
    fixture = Fixture(size=SMALL)
    reported: list[float] = []
    made = [
        figure
        for make in (chapter2_figures, chapter3_figures, chapter4_figures)
        for figure in make(fixture, lambda _what, fraction: reported.append(fraction))
    ]
    assert all(0.0 <= fraction < 1.0 for fraction in reported)
    assert len({figure.key for figure in made}) == len(made)
    return {figure.key: figure for figure in made}


def cells(figure: ThesisFigure, row: str, column: str) -> list[float]:
    """Return the numbers of one column in the rows that hold some text."""
    (grid,) = figure.grids
    place = grid.columns.index(column)
    return [float(found[place]) for found in grid.rows if row in found]


def test_every_figure_of_chapter_four_is_there(figures: Figures) -> None:
    names = {figure.thesis for figure in figures.values()}
    assert {f"Figure 4.{place}" for place in range(1, 11)} <= names


def test_sentences_hold_finite_numbers_and_no_dash_in_place_of_one(figures: Figures) -> None:
    for figure in figures.values():
        text = f"{figure.shows} {figure.agrees} {figure.differs}"
        assert not re.search(r"\bnan\b|\binf\b|–", text), figure.key


def test_figures_of_real_logs_say_that_they_are_missing(figures: Figures) -> None:
    missing = {key for key, figure in figures.items() if figure.missing}
    assert missing == {"figure-4-2-husky", "figure-4-9-husky"}


def test_three_degrees_of_freedom_fit_as_the_polynomial_does_and_translation_does_not(
    figures: Figures,
) -> None:
    column = "cost (4.1) [m²]"
    free, polynomial, translation = (
        np.array(cells(figures["figure-4-2"], row, column))
        for row in ("three degrees of freedom", "second-order polynomial", "forward and side slip only")
    )
    np.testing.assert_allclose(free, polynomial, rtol=0.05)
    assert np.all(translation > 5.0 * free)


def test_fitted_slip_rates_are_those_that_the_robot_truly_had(figures: Figures) -> None:
    for panel in figures["figure-4-9"].panels:
        fitted = [series for series in panel.series if isinstance(series, ErrorBars)]
        true = [series for series in panel.series if isinstance(series, Points)]
        for found, known in zip(fitted, true, strict=True):
            np.testing.assert_allclose(found.y, known.y, atol=0.02)


def test_runge_kutta_is_of_fourth_order_and_the_exact_step_is_exact(figures: Figures) -> None:
    runge_kutta, exact = (s for s in figures["equation-3-9"].panels[0].series if isinstance(s, Points))
    order = np.polyfit(np.log(runge_kutta.x), np.log(runge_kutta.y), 1)[0]
    assert 3.8 < order < 4.2
    assert np.max(exact.y) < 1e-13


def test_rates_of_a_real_husky_are_linear_in_the_yaw_rate(real_log_dir: Path) -> None:
    fixture = Fixture(data=real_log_dir)
    angular = next(s for s in husky_rates(fixture).panels[2].series if isinstance(s, ErrorBars))
    assert np.corrcoef(angular.x, angular.y)[0, 1] < -0.99
    curves = husky_curves(fixture)
    translation = cells(curves, "forward and side slip only", "cost (4.1) [m²]")
    assert np.all(
        np.array(translation) > 3.0 * np.array(cells(curves, "three degrees of freedom", "cost (4.1) [m²]"))
    )
