# SPDX-License-Identifier: Apache-2.0
"""A simpler basis is proposed where it predicts clearly better, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from calibration.test_statistics import predictions
from contradictory_logs import sound_log

from slipwise.calibration import calibrate, make_settings
from slipwise.evaluation import Evaluation, proposing, simpler_method

WINDOWS = 80


def table(**scales: float | tuple[float, float]) -> Evaluation:
    """An evaluation whose methods err by these factors, in position and heading, of the same errors."""
    rng = np.random.default_rng(2)
    errors = np.abs(rng.standard_normal((WINDOWS, 3))) + 0.1
    made = []
    for name, scale in scales.items():
        position, heading = scale if isinstance(scale, tuple) else (scale, scale)
        own = errors * np.array([position, position, heading]) * rng.uniform(0.9, 1.1, (WINDOWS, 1))
        whole = predictions(own, np.zeros((WINDOWS, 3)), np.broadcast_to(np.eye(3), (WINDOWS, 3, 3)).copy())
        made.append(replace(whole, method=name.replace("_", "-"), learned_until=whole.t_start - 1.0))
    methods = tuple(p.method for p in made)
    return Evaluation("wheel", (made[0].horizon,), methods, (), tuple(made), ("run",), (), ())


def test_the_best_of_the_clearly_better_is_proposed_with_its_errors() -> None:
    found = simpler_method(table(none=2.0, edd_2=0.5, drive_5=0.7, auto=1.0), "auto")
    assert found is not None
    assert found.method == "edd-2"
    assert found.position_ratio[0] == pytest.approx(0.5, abs=0.02)
    assert found.advice().startswith("edd-2, of 2 slip terms, predicts clearly better: ")
    assert found.advice().endswith("Use --basis edd-2.")


@pytest.mark.parametrize(
    "scales",
    [
        {"none": 0.5, "auto": 1.0},  # the baseline is no method to use: the verdict speaks of it
        {"edd_2": 0.97, "auto": 1.0},  # hardly better
        {"edd_2": (0.5, 1.2), "auto": 1.0},  # worse in heading
        {"edd_2": 1.3, "auto": 1.0},
    ],
)
def test_nothing_is_proposed_that_is_not_clearly_better(scales: dict[str, float]) -> None:
    assert simpler_method(table(**scales), "auto") is None


def test_of_a_model_file_that_what_this_log_teaches_is_better_says_that_the_robot_changed() -> None:
    evaluation = replace(table(model=1.0, edd_2=0.5, auto=0.4), models=("model",))
    found = simpler_method(evaluation, "model")
    assert found is not None
    assert found.advice().startswith("What this log itself teaches (auto) predicts clearly better: ")
    assert found.advice().endswith("calibrate from this log, and compare the two models.")
    assert simpler_method(replace(table(model=1.0, auto=0.95), models=("model",)), "model") is None


def test_of_two_bases_only_the_one_with_fewer_terms_is_simpler() -> None:
    bases = table(edd_2=0.5, odd_even_10=1.0)
    swapped = table(edd_2=1.0, odd_even_10=0.5)
    assert simpler_method(bases, "odd-even-10") is not None
    assert simpler_method(swapped, "edd-2") is None


def test_a_method_that_has_seen_the_windows_is_not_proposed() -> None:
    evaluation = table(edd_2=0.5, auto=1.0)
    seen = replace(evaluation.predictions[0], learned_until=np.full(WINDOWS, 1e9))
    assert simpler_method(replace(evaluation, predictions=(seen, evaluation.predictions[1])), "auto") is None


def test_a_calibration_proposes_it_where_its_report_shows_one() -> None:
    calibration = calibrate(sound_log(), input="wheel", settings=make_settings({"basis": "odd-even-10"}))
    advised = proposing(calibration, table(edd_2=0.5, odd_even_10=1.0))
    assert advised.verdict.advice[-1].startswith("edd-2, of 2 slip terms, predicts clearly better: ")
    assert advised.verdict.advice[:-1] == calibration.verdict.advice
    assert proposing(calibration, table(edd_2=1.0, odd_even_10=0.5)) is calibration
