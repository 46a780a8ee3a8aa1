# SPDX-License-Identifier: Apache-2.0
"""The slip-ratio rivals learn what is theirs to learn, causally, from wheel speeds alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import SettingsError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Log, open_log
from slipwise_thesis.slip_ratios import slip_ratio_filter, slip_ratio_observer

METHODS = ("none", "icr-3", "slip-ratio-ekf", "slip-ratio-smo")
RIVALS = METHODS[2:]
TRACK = 0.8
LEFT, RIGHT, ANGLE = 0.2, 0.05, 0.1
MEAN, HALF, TAN = (LEFT + RIGHT) / 2, (RIGHT - LEFT) / 2, np.tan(ANGLE)
ALPHA = (
    *(-MEAN, -TRACK / 2 * HALF),
    *(-TAN * (1 - MEAN), TAN * TRACK / 2 * HALF),
    *(-HALF / (TRACK / 2), -MEAN),
)
SETTINGS = make_settings({"log": {"wheel_separation": TRACK}})


@cache
def crooked() -> Log:
    """A robot whose sides slip by constant ratios."""
    basis = _core.named_basis("full-linear-6")
    return simulated_log(Drive(seconds=120.0, basis=basis, alpha=tuple(map(float, ALPHA)), speeds=(0.3, 1.5)))


@cache
def judged() -> Evaluation:
    options = EvaluationOptions(methods=METHODS, horizons=(2.0, 5.0))
    return evaluate(crooked(), input="wheel", settings=SETTINGS, options=options)


@pytest.mark.parametrize("method", RIVALS)
def test_constant_slip_ratios_are_learned_and_beat_the_icr(method: str) -> None:
    score, icr = judged().score(method, 5.0), judged().score("icr-3", 5.0)
    assert score.position_ratio[0] < 0.3
    assert score.heading_ratio[0] < 0.3
    assert score.heading.mean < icr.heading.mean
    assert score.causal


def test_both_rivals_find_the_true_terms() -> None:
    windows = learning_windows(prepare_run(crooked(), "wheel"), "wheel", SETTINGS)
    for make, tolerance in ((slip_ratio_filter, 0.03), (slip_ratio_observer, 0.06)):
        mean = make("wheel", SETTINGS, windows).posterior(len(windows)).mean
        np.testing.assert_allclose(mean, ALPHA, atol=tolerance / TRACK)


def test_filter_carries_a_covariance_and_the_observer_the_noise_shape_alone() -> None:
    windows = learning_windows(prepare_run(crooked(), "wheel"), "wheel", SETTINGS)
    assert np.linalg.matrix_rank(slip_ratio_filter("wheel", SETTINGS, windows).posterior(5).covariance) == 3
    assert not slip_ratio_observer("wheel", SETTINGS, windows).posterior(5).covariance.any()


@pytest.mark.parametrize("make", [slip_ratio_filter, slip_ratio_observer])
def test_nothing_learned_is_unlearned(make: object) -> None:
    assert callable(make)
    windows = learning_windows(prepare_run(crooked(), "wheel"), "wheel", SETTINGS)
    predictor = make("wheel", SETTINGS, windows)
    predictor.posterior(5)
    with pytest.raises(ValueError, match="after 3 windows is gone"):
        predictor.posterior(3)


@pytest.mark.parametrize("method", RIVALS)
def test_poses_within_the_embargo_do_not_reach_a_prediction(method: str) -> None:
    log = crooked()
    options = EvaluationOptions(methods=(method,), horizons=(2.0,))
    (whole,) = evaluate(log, input="wheel", settings=SETTINGS, options=options).predictions
    for i in (len(whole) // 3, len(whole) - 1):
        embargo = float(whole.t_start[i]) - 2.0
        poses = log.runs[0].poses
        late = poses.t > embargo + 1e-6
        spoilt = replace(poses, x=poses.x + 0.3 * late, y=poses.y - 0.2 * late)
        changed = replace(log, runs=(replace(log.runs[0], poses=spoilt),))
        (other,) = evaluate(changed, input="wheel", settings=SETTINGS, options=options).predictions
        np.testing.assert_array_equal(other.pose[i], whole.pose[i])
        np.testing.assert_array_equal(other.covariance[i], whole.covariance[i])
        assert whole.learned_until[i] <= embargo + 1e-6


@pytest.mark.parametrize("method", RIVALS)
def test_commands_are_refused_with_advice(method: str) -> None:
    with pytest.raises(
        SettingsError, match=f"{method} learns slip between wheels and terrain.*--input wheel"
    ):
        evaluate(crooked(), input="command", options=EvaluationOptions(methods=(method,)))


def test_icr_learns_sideways_motion_of_a_real_skid_steered_robot(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "husky/tile_deflated_tyres.csv.gz")
    options = EvaluationOptions(methods=("none", "edd-2", "icr-3", *RIVALS), horizons=(2.0,))
    result = evaluate(log, input="wheel", options=options)
    errors = {m: result.score(m, 2.0).position.mean for m in result.methods}
    assert errors["icr-3"] < 0.5 * errors["edd-2"]
    assert np.isfinite([errors[m] for m in RIVALS]).all()
    assert min(errors[m] for m in RIVALS) > errors["icr-3"]  # slip ratios change sides with every turn
