# SPDX-License-Identifier: Apache-2.0
"""The section of the errors over time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import make_results

from slipwise.reporting.sections.errors import ErrorsSection

NAMES = ["kinematic baseline", "edd-2", "slipwise"]


def test_plain_simple_and_learned_errors_are_drawn_over_time() -> None:
    contents = contents_of(make_results())
    figures = figures_of(ErrorsSection().html(contents))
    assert list(figures) == ["figure-error-position", "figure-error-heading"]
    assert [trace["name"] for trace in figures["figure-error-heading"]["data"]] == [
        "kinematic baseline",
        "edd-2",
        "slipwise",
    ]
    auto = contents.predictions("auto", 5.0)
    assert auto is not None
    shown = figures["figure-error-heading"]["data"][2]["y"]
    assert np.allclose(shown, np.degrees(auto.heading_error), rtol=1e-5)


def test_log_scale_is_offered_for_both() -> None:
    assert ErrorsSection().html(contents_of(make_results())).count("data-log-scale=") == 2


def test_line_breaks_between_runs() -> None:
    figure = figures_of(ErrorsSection().html(contents_of(make_results(runs=2))))["figure-error-position"]
    assert figure["data"][0]["y"].count(None) == 1
    assert len(figure["layout"]["shapes"]) == 1


def test_evaluation_without_predictions_gives_a_sentence() -> None:
    results = make_results()
    bare = replace(results, evaluation=replace(results.evaluation, predictions=()))
    assert "No window was predicted" in ErrorsSection().html(contents_of(bare))
