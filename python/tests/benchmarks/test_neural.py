# SPDX-License-Identifier: Apache-2.0
"""Networks as methods: they learn slip from the past alone, and correct what a filter cannot predict."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.util import find_spec

import numpy as np
import pytest
from neural import FIRST, add_networks, last_known, neural_residual
from sample_logs import Drive, log_until, simulated_log

from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Log

pytestmark = pytest.mark.skipif(find_spec("sklearn") is None, reason="neural networks need scikit-learn")

add_networks()

HORIZON = 2.0
SLIP = _core.named_basis("full-linear-6")
ALPHA = (-0.1, 0.02, 0.03, 0.05, 0.02, -0.3)


@cache
def slipping() -> Log:
    return simulated_log(Drive(seconds=120.0, basis=SLIP, alpha=ALPHA))


def judged(log: Log, methods: tuple[str, ...]) -> Evaluation:
    options = EvaluationOptions(methods=("none", *methods), horizons=(HORIZON,))
    return evaluate(log, input="wheel", settings=make_settings({}), options=options)


def of(evaluation: Evaluation, method: str) -> Predictions:
    return next(p for p in evaluation.predictions if p.method == method)


@cache
def own() -> tuple[WindowSet, Predictions]:
    """The windows, and what `auto` predicts of them."""
    settings = make_settings({})
    drive = prepare_run(slipping(), "wheel")
    windows = collect_windows(drive, HORIZON, settings.rules())
    return windows, learn_log(drive, settings, [HORIZON]).predictions[0]


@pytest.mark.slow
def test_networks_learn_slip_and_auto_is_no_worse() -> None:
    result = judged(slipping(), ("neural", "neural-residual", "auto"))
    forward, corrected, auto = (result.score(m, HORIZON) for m in ("neural", "neural-residual", "auto"))
    assert forward.causal
    assert corrected.causal
    assert forward.heading_ratio[0] < 0.5
    assert corrected.position.mean < 1.2 * auto.position.mean
    assert auto.position.mean < forward.position.mean
    assert 1.0 < corrected.nis < 9.0


@pytest.mark.slow
def test_what_comes_later_does_not_reach_a_prediction() -> None:
    whole = of(judged(slipping(), ("neural",)), "neural")
    part = of(judged(log_until(slipping(), 70.0), ("neural",)), "neural")
    assert len(part) > 1.5 * FIRST
    np.testing.assert_allclose(part.pose, whole.pose[: len(part)], atol=1e-9)
    np.testing.assert_allclose(part.covariance, whole.covariance[: len(part)], rtol=1e-6)


def test_before_the_first_fit_the_forward_model_is_the_kinematic_baseline() -> None:
    result = judged(log_until(slipping(), 25.0), ("neural",))
    np.testing.assert_array_equal(of(result, "neural").pose, of(result, "none").pose)


@pytest.mark.slow
def test_an_error_of_the_filter_that_inputs_explain_is_corrected_and_its_covariance_kept() -> None:
    windows, predictions = own()
    missed = 0.4 * predictions.pose[:, 2]  # m sideways
    spoilt = replace(predictions, pose=predictions.pose - np.outer(missed, (0.0, 1.0, 0.0)))
    corrected = neural_residual(windows, spoilt)
    half = slice(len(windows) // 2, None)
    assert corrected.position_error[half].mean() < 0.7 * spoilt.position_error[half].mean()
    np.testing.assert_allclose(
        corrected.covariance / corrected.inflation[:, None, None],
        predictions.covariance / predictions.inflation[:, None, None],
    )


def test_the_last_known_row_is_that_of_the_last_example() -> None:
    rows = np.arange(6.0).reshape(3, 2) + 1.0
    np.testing.assert_array_equal(last_known(rows, np.array([0, 1, 3])), [[0.0, 0.0], [1.0, 2.0], [5.0, 6.0]])
