# SPDX-License-Identifier: Apache-2.0
"""The figure of the inputs driven."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import Results, make_results

from slipwise.logs.log import Inputs, Log
from slipwise.reporting.sections.surfaces import coverage_figure


def _html(results: Results) -> str:
    figure = coverage_figure(contents_of(results))
    assert figure is not None
    return figure.html()


def test_histogram_adds_up_to_the_time_driven() -> None:
    figure = figures_of(_html(make_results()))["figure-coverage"]
    seconds = np.array(figure["data"][0]["customdata"])
    assert np.isclose(seconds.sum(), 119.9, atol=1e-3)
    shown = np.array([[np.nan if z is None else z for z in row] for row in figure["data"][0]["z"]])
    assert np.array_equal(np.isnan(shown), seconds == 0.0)


def test_range_of_the_model_is_a_box() -> None:
    figure = figures_of(_html(make_results()))["figure-coverage"]
    box = figure["layout"]["shapes"][0]
    assert [box[key] for key in ("x0", "x1", "y0", "y1")] == [0.2, 1.8, -0.7, 0.7]


def test_input_older_than_half_a_second_is_unknown() -> None:
    results = make_results()
    t = np.array([0.0, 10.0, 10.1])
    sparse = Inputs(t=t, v=np.ones(3), vy=np.zeros(3), omega=np.zeros(3))
    log = Log(runs=(replace(results.log.runs[0], commands=sparse),))
    html = _html(replace(results, log=log))
    assert "1 s in all" in html


def test_log_without_wheel_speeds_has_no_figure_where_these_were_asked_for() -> None:
    results = make_results()
    wheel = replace(results, evaluation=replace(results.evaluation, input="wheel"))
    assert coverage_figure(contents_of(wheel)) is None
