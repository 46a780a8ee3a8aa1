# SPDX-License-Identifier: Apache-2.0
"""The section of the parameters while learning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of, text_of
from reporting.synthetic_results import Results, make_results, with_model, without_history

from slipwise.calibration.smoothing import SmoothedCourse
from slipwise.models.schema import Parameter, Slip
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


def test_lag_is_shown_in_seconds() -> None:
    lag = Parameter(
        name="log_time_constant_v",
        stage="actuator",
        unit="ln s",
        value=np.log(0.8),
        std=0.1,
        prior_std=1.0,
        identifiable=True,
    )
    rest = [
        lag.model_copy(update={"name": f"log_{name}"})
        for name in ("time_constant_omega", "delay_v", "delay_omega")
    ]
    results = make_results()
    parameters = [*results.calibration.model.content.parameters, lag, *rest]
    learned = with_model(
        results,
        dynamics=True,
        parameters=parameters,
        covariance=np.diag([p.std**2 for p in parameters]).tolist(),
    )
    history = results.calibration.history
    assert history is not None
    six = replace(
        history,
        names=tuple(p.name for p in parameters),
        mean=np.tile([p.value for p in parameters], (len(history.t), 1)),
        std=np.tile([p.std for p in parameters], (len(history.t), 1)),
    )
    learned = replace(learned, calibration=replace(learned.calibration, history=six))
    html = ConvergenceSection().html(contents_of(learned))
    assert "time_constant_v" in html
    assert np.allclose(figures_of(html)["figure-parameter-3"]["data"][1]["y"], 0.8)
    assert "0.800 s, ± 1 sigma: 0.724 to 0.884" in text_of(html)


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


def test_single_basis_is_named_instead_of_weights() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    one = replace(history, bases=("edd-2",), basis_weight=np.ones((len(history.t), 1)))
    html = ConvergenceSection().html(
        contents_of(replace(results, calibration=replace(results.calibration, history=one)))
    )
    assert "figure-weights" not in figures_of(html)
    assert "One basis was used: edd-2." in html


def test_course_of_other_parameters_and_empty_course_give_sentences() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    other = replace(history, names=("a", "b"))
    empty = replace(
        history,
        **{
            name: getattr(history, name)[:0]
            for name in ("run", "t", "mean", "std", "nis", "weight", "basis_weight")
        },
    )
    for changed, words in ((other, "not that of the model"), (empty, "No window was learned")):
        calibration = replace(results.calibration, history=changed)
        assert words in ConvergenceSection().html(contents_of(replace(results, calibration=calibration)))


def test_model_without_parameters_gives_a_sentence() -> None:
    assert "has no parameters" in ConvergenceSection().html(contents_of(_without_slip(make_results())))


def _without_slip(results: Results) -> Results:
    return with_model(results, slip=Slip(basis="none", lon=[], lat=[], ang=[]), parameters=[], covariance=[])


def test_changes_of_terrain_are_said_in_times_from_the_start_and_marked() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    html = ConvergenceSection().html(contents_of(results))
    assert "2 changes of terrain found, marked by an orange line: 52.5 s, 55.0 s." in text_of(html)
    shapes = figures_of(html)["figure-parameter-1"]["layout"]["shapes"]
    marks = [shape["x0"] for shape in shapes if shape["line"]["color"] == ALARM_COLOUR]
    assert np.allclose(marks, history.t[history.alarm] - history.t[0] + 2.5)


def test_one_terrain_is_said_too() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    quiet = replace(history, alarm=np.zeros_like(history.alarm))
    same = replace(results, calibration=replace(results.calibration, history=quiet))
    assert "No change of terrain was found." in text_of(ConvergenceSection().html(contents_of(same)))
