# SPDX-License-Identifier: Apache-2.0
"""The section of the parameters while learning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of, text_of
from reporting.synthetic_results import make_results, without_history

from slipwise.calibration.smoothing import SmoothedCourse
from slipwise.reporting.palette import ALARM_COLOUR
from slipwise.reporting.sections.convergence import ConvergenceSection


def test_parameter_that_explains_most_comes_first_with_its_band() -> None:
    results = make_results()
    figures = figures_of(ConvergenceSection().html(contents_of(results)))
    assert list(figures) == ["figure-parameter-1", "figure-parameter-2", "figure-weights"]
    band, value = figures["figure-parameter-1"]["data"]
    history = results.calibration.history
    assert history is not None
    assert np.allclose(value["y"], history.mean[:, 1], rtol=1e-5)
    assert np.allclose(
        band["y"][: len(history.t)], history.mean[:, 1] + history.std[:, 1], rtol=1e-5, atol=1e-6
    )


def test_weights_of_all_bases_are_stacked() -> None:
    figure = figures_of(ConvergenceSection().html(contents_of(make_results())))["figure-weights"]
    assert [trace["name"] for trace in figure["data"]] == ["no slip", "edd-2", "drive-5"]
    assert np.allclose(np.sum([trace["y"] for trace in figure["data"]], axis=0), 1.0, atol=3e-4)


def test_weights_of_both_ways_to_learn_are_drawn_with_one_basis_or_many() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    count = len(history.t)
    cascade = np.linspace(0.1, 0.8, count)
    two = replace(
        history, structures=("joint", "cascaded"), structure_weight=np.column_stack((1 - cascade, cascade))
    )
    one = replace(two, bases=("edd-2",), basis_weight=np.ones((count, 1)))
    for shown in (two, one):
        learned = replace(results, calibration=replace(results.calibration, history=shown))
        html = ConvergenceSection().html(contents_of(learned))
        joint, other = figures_of(html)["figure-structures"]["data"]
        assert (joint["name"], other["name"]) == ("joint", "cascaded")
        assert np.allclose(other["y"], cascade, atol=3e-4)
        assert "those of the heavier way, at the end cascaded" in text_of(html)
        assert "cascaded 0.80" in text_of(html)


def test_batch_fit_shows_the_values_and_says_why_no_course() -> None:
    text = text_of(ConvergenceSection().html(contents_of(without_history(make_results()))))
    assert "fitted to the whole log at once" in text
    assert "lon.V −0.049 ± 0.004 m/s per V yes" in text


def test_smoothed_parameters_have_figures_of_their_own_with_or_without_a_history() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    course = SmoothedCourse(
        history.run, history.t - 1.0, history.t, history.names, history.mean + 1.0, history.std
    )
    for learned in (results, without_history(results)):
        smoothed = replace(learned, calibration=replace(learned.calibration, smoothed=course))
        html = ConvergenceSection().html(contents_of(smoothed))
        _, value = figures_of(html)["figure-smoothed-1"]["data"]
        assert np.allclose(value["y"], history.mean[:, 1] + 1.0, rtol=1e-5)
        assert "nothing is predicted with it" in text_of(html)
    assert "figure-smoothed-1" not in figures_of(ConvergenceSection().html(contents_of(results)))


def test_changes_of_terrain_are_said_in_times_from_the_start_and_marked() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    html = ConvergenceSection().html(contents_of(results))
    assert "2 changes of terrain found, marked by an orange line: 52.5 s, 55.0 s." in text_of(html)
    shapes = figures_of(html)["figure-parameter-1"]["layout"]["shapes"]
    marks = [shape["x0"] for shape in shapes if shape["line"]["color"] == ALARM_COLOUR]
    assert np.allclose(marks, history.t[history.alarm] - history.t[0] + 2.5)
