# SPDX-License-Identifier: Apache-2.0
"""Chapter 6 on small drives: what is recorded is what is evaluated, and figures hold what they claim."""

from __future__ import annotations

import re

import numpy as np
import pytest

from slipwise import _core
from slipwise.calibration.plain import baseline_predictor
from slipwise.calibration.predictors import predictions_of
from slipwise.logs import Log
from slipwise_thesis import SMALL, Fixture, Heat, Line, ThesisFigure, _thesis
from slipwise_thesis.chapter6 import chapter6_figures
from slipwise_thesis.chapter6_circling import circling
from slipwise_thesis.chapter6_convergence import without_slip
from slipwise_thesis.chapter6_jacobian import fractions_wrong
from slipwise_thesis.chapter6_recording import EXACT, Course, drive_windows, record
from slipwise_thesis.chapter6_smoothing import drifting_drive
from slipwise_thesis.chapter6_table import (
    METHODS,
    PRINTED,
    Contest,
    Errors,
    gain_findings,
    order_findings,
)
from slipwise_thesis.estimator_run import run_estimator

pytestmark = pytest.mark.slow

pytest.importorskip("mujoco")

Figures = dict[str, ThesisFigure]


@pytest.fixture(scope="module")
def fixture() -> Fixture:
    return Fixture(size=SMALL)


@pytest.fixture(scope="module")
def figures(fixture: Fixture) -> Figures:
    reported: list[float] = []
    made = chapter6_figures(fixture, lambda _what, fraction: reported.append(fraction))
    assert reported == sorted(reported)
    assert all(0.0 <= fraction < 1.0 for fraction in reported)
    return {figure.key: figure for figure in made}


@pytest.fixture(scope="module")
def circles(fixture: Fixture) -> Log:
    return circling(fixture, "tyre-force")


def test_every_figure_and_table_is_there_with_finite_numbers(figures: Figures) -> None:
    names = {figure.thesis for figure in figures.values()}
    assert {f"Figure 6.{place}" for place in range(1, 8)} | {"Table 6.2"} <= names
    for figure in figures.values():
        text = f"{figure.shows} {figure.agrees} {figure.differs}"
        assert not re.search(r"\bnan\b|\binf\b|–", text), figure.key
        assert not re.search(r"[.:] [a-z]\w* is best", text), figure.key


def test_slip_surfaces_bring_a_drive_near_to_physics(figures: Figures) -> None:
    lines = {line.label: line for line in figures["figure-6-1"].panels[0].series if isinstance(line, Line)}
    ends = {label: np.array([line.x[-1], line.y[-1]]) for label, line in lines.items()}
    physics = ends["rigid-body physics"]
    ideal = np.linalg.norm(ends["ideal: commands without slip"] - physics)
    assert np.linalg.norm(ends["mean surfaces"] - physics) < 0.2 * ideal


def test_table_has_every_estimator_and_learning_beats_no_slip(figures: Figures) -> None:
    for terrain in ("tyre-force", "contact-friction"):
        for grid in figures[f"table-6-2-{terrain}"].grids[:2]:
            rows = {row[0]: row for row in grid.rows}
            assert set(METHODS) < set(rows)
            place = grid.columns.index("honest position [m]")
            honest = {name: float(row[place].split(" ±")[0]) for name, row in rows.items()}
            assert max(honest[name] for name in ("iekf", "delayed-state", "auto")) < 0.5 * honest["none"]


def test_ratios_of_the_thesis_are_those_of_its_errors() -> None:
    errors = {name: (float(position[:4]), float(heading[:4])) for name, position, heading, _ in PRINTED}
    for name, _, _, better in PRINTED:
        ratios = [baseline / mine for baseline, mine in zip(errors["None"], errors[name], strict=True)]
        np.testing.assert_allclose([float(value) for value in better.split(", ")], ratios, rtol=0.02)


def contest_of(**in_sample: tuple[float, float]) -> Contest:
    """Return errors of two segments each, with these means, position [m] and heading [rad]."""
    return {name.replace("_", "-"): Errors(*[np.array([mean, mean])] * 2) for name, mean in in_sample.items()}


def test_what_agrees_and_what_does_not_follows_from_the_errors() -> None:
    baseline, default = (1.0, 0.8), (0.1, 0.02)
    as_printed = contest_of(none=baseline, auto=default, gradient_descent=(0.4, 0.08), ekf_thesis=(0.2, 0.04))
    turned = contest_of(none=baseline, auto=(0.3, 0.02), gradient_descent=(0.2, 0.08), ekf_thesis=(0.4, 0.04))
    contests = {"wheel": as_printed, "command": turned}
    gained, ordered = gain_findings(contests), order_findings(contests)
    assert [finding.same for finding in gained] == [True, True, False, False]
    assert [finding.same for finding in ordered] == [True, True, False, True]
    assert gained[3].text == "the thesis's own filter from commands (2.5 and 20 times)"
    assert ordered[2].text == "from commands in position (0.400 beside 0.200 m)"


def test_the_table_says_where_it_contradicts_the_thesis(figures: Figures) -> None:
    """Each in-sample comparison of its own rows stands once, on the side where it belongs."""
    for terrain in ("tyre-force", "contact-friction"):
        figure = figures[f"table-6-2-{terrain}"]
        for grid, name in zip(figure.grids, ("commands", "wheel speeds"), strict=False):
            rows = {row[0]: row for row in grid.rows}
            for what, unit in (("position", "m"), ("heading", "rad")):
                place = grid.columns.index(f"in-sample {what} [{unit}]")
                kalman, descent = (rows[n][place].split(" ±")[0] for n in ("ekf-thesis", "gradient-descent"))
                text = f"from {name} in {what} ({kalman} beside {descent} {unit})"
                agrees = float(kalman) < float(descent)
                assert (text in figure.agrees) is agrees
                assert (text in figure.differs) is not agrees


def test_correlations_are_ones_on_the_diagonal(figures: Figures) -> None:
    for panel in figures["figure-6-6"].panels:
        (heat,) = panel.series
        assert isinstance(heat, Heat)
        np.testing.assert_allclose(np.diag(heat.values), 1.0)
        assert np.abs(heat.values).max() <= 1.0 + 1e-9


@pytest.mark.parametrize("name", ["gradient-descent", "ekf-thesis", "iekf", "delayed-state"])
def test_a_recording_has_the_posterior_of_the_evaluation(name: str, circles: Log) -> None:
    course = Course(name)
    recording = record(circles, course)
    settings = course.settings.model_copy(update={"estimator": name})
    run = run_estimator(settings, course.input_name, recording.windows)
    for count in (0, 7, len(recording.windows)):
        mine, theirs = recording.posterior(count), run.posterior(count)
        np.testing.assert_array_equal(mine.mean, theirs.mean)
        np.testing.assert_array_equal(mine.covariance, theirs.covariance)
        np.testing.assert_array_equal(mine.noise_scale, theirs.noise_scale)


def test_the_exact_jacobian_changes_what_the_filter_learns(circles: Log) -> None:
    thesis, exact = (
        record(circles, course) for course in (Course("ekf-thesis"), Course("ekf-thesis", jacobian=EXACT))
    )
    assert not np.allclose(thesis.mean[-1], exact.mean[-1])


def test_residuals_without_slip_are_those_of_the_baseline_model(circles: Log) -> None:
    recording = record(circles, Course("iekf"))
    baseline = baseline_predictor(recording.course.settings)
    predictions = predictions_of(baseline, recording.windows, recording.fed)
    np.testing.assert_allclose(without_slip(recording), predictions.residual, atol=1e-12)


def test_the_thesis_jacobian_is_worse_over_longer_segments(circles: Log) -> None:
    fractions = [fractions_wrong(circles, length)[0] for length in (0.5, 2.0, 5.0)]
    assert fractions == sorted(fractions)
    assert fractions[-1] > 0.4
    windows = drive_windows(circles, Course("iekf"), 5.0)
    motion = _core.MotionModel(_core.named_basis("thesis-15"), False, False)
    at = _core.linearize_segment(motion, np.zeros(15), windows.input_history(0), windows.segments[0])
    thesis, exact = (
        np.array(_thesis.segment_jacobian(kind, motion, at, windows.segments[0]))
        for kind in (_thesis.SegmentJacobian.Thesis, EXACT)
    )
    np.testing.assert_allclose(thesis[2], exact[2], atol=1e-12)


def test_smoothing_comes_nearer_to_the_truth_than_filtering_and_ends_where_it_does() -> None:
    found = drifting_drive(3, 300.0)
    errors = [np.mean(np.square(mean - found.truth), axis=0) for mean, _ in (found.filtered, found.smoothed)]
    assert np.all(errors[1] < 0.8 * errors[0])
    np.testing.assert_allclose(found.smoothed[0][-1], found.filtered[0][-1], rtol=1e-9)
    assert np.all(found.smoothed[1] <= found.filtered[1] + 1e-12)
