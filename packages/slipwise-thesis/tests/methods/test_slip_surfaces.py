# SPDX-License-Identifier: Apache-2.0
"""Slip surfaces as methods: they learn what is there, from few or dull data too, and from the past alone."""

import sys
from functools import cache

import numpy as np
import pytest
from python.tests.evaluation.test_causality import by_name, same
from sample_logs import Drive, log_until, simulated_log

from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import SettingsError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Log
from slipwise_thesis.slip_surfaces import surface_predictor
from slipwise_thesis.window_examples import window_examples

LINEAR = ("surface-least-squares", "surface-bayesian")
PROCESS = "surface-gaussian-process"
SLIP = _core.named_basis("full-linear-6")
ALPHA = (-0.1, 0.02, 0.03, 0.05, 0.02, -0.3)
SETTINGS = make_settings({"basis": "full-linear-6"})


@cache
def slipping() -> Log:
    return simulated_log(Drive(seconds=150.0, basis=SLIP, alpha=ALPHA, lag=0.4, delay=0.1))


def judged(log: Log, methods: tuple[str, ...], *, input_name: str = "command") -> Evaluation:
    options = EvaluationOptions(methods=("none", *methods), horizons=(1.0, 2.0))
    return evaluate(log, input=input_name, settings=SETTINGS, options=options)


def needs_scikit_learn(method: str) -> None:
    if method == PROCESS:
        pytest.importorskip("sklearn", reason="the Gaussian process needs scikit-learn")


@pytest.mark.slow
@pytest.mark.parametrize("method", [*LINEAR, PROCESS])
@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_a_surface_learns_slip_beside_lag_and_comes_near_the_filter_of_its_terms(
    method: str, input_name: str
) -> None:
    needs_scikit_learn(method)
    result = judged(slipping(), (method, "edd-2", "full-linear-6"), input_name=input_name)
    score, two, rival = (result.score(name, 2.0) for name in (method, "edd-2", "full-linear-6"))
    assert score.causal
    assert score.heading_ratio[0] < 0.2
    assert score.position.mean < 0.6 * two.position.mean
    # From commands the lag is that of edd-2, which takes some slip for lag.
    assert score.position.mean < (1.1 if input_name == "wheel" else 2.2) * rival.position.mean
    assert 0.5 < score.nis < 9.0


def test_slip_rates_of_windows_are_those_of_a_steady_drive() -> None:
    drive = Drive(
        seconds=20.0,
        basis=SLIP,
        alpha=ALPHA,
        speeds=(1.0, 1.0),
        yaw_rates=(0.4, 0.4),
        pose_std=(0.0, 0.0),
        slip_psd=(0.0, 0.0, 0.0),
    )
    windows = learning_windows(prepare_run(simulated_log(drive), "wheel"), "wheel", SETTINGS)
    wrong = _core.MotionModel(_core.named_basis("edd-2"), False, False), np.array([0.2, -0.5])
    examples = window_examples(wrong, windows, np.arange(3))
    assert examples is not None
    true = _core.slip_rate(SLIP, np.array(ALPHA), _core.SlipState(1.0, 0.4, 0.0, 0.0))
    np.testing.assert_allclose(examples.slip, np.tile(true, (3, 1)), atol=1e-9)
    np.testing.assert_allclose(examples.v, 1.0, atol=1e-9)
    np.testing.assert_allclose(examples.omega, 0.4, atol=1e-9)


def test_the_gaussian_process_predicts_from_the_past_alone() -> None:
    needs_scikit_learn(PROCESS)
    log = log_until(slipping(), 90.0)
    whole = judged(log, (PROCESS,))
    until = float(whole.predictions[0].t_end[68])
    there = by_name(whole)
    part = by_name(judged(log_until(log, until), (PROCESS,)))
    assert part.keys() == there.keys()
    for key, here in part.items():
        before_cut = len(here) - 1  # the last pose may stand in for a nearer one behind the cut
        assert before_cut >= 30
        for i in range(before_cut):
            same(there[key], i, here, i)


@pytest.mark.parametrize("method", [*LINEAR, PROCESS])
def test_one_speed_alone_is_learned(method: str) -> None:
    needs_scikit_learn(method)
    dull = Drive(seconds=60.0, basis=SLIP, alpha=ALPHA, speeds=(1.0, 1.0), yaw_rates=(0.4, 0.4))
    result = judged(simulated_log(dull), (method,))
    assert result.score(method, 2.0).heading_ratio[0] < 0.3
    assert result.score(method, 2.0).position_ratio[0] < 0.5
    assert all(np.isfinite(p.covariance).all() for p in result.predictions)


@pytest.mark.parametrize("method", ["surface-least-squares", PROCESS])
def test_what_one_speed_does_not_determine_keeps_its_prior(method: str) -> None:
    needs_scikit_learn(method)
    settings = make_settings({"basis": "full-linear-6", "learn_clock_offset": False})
    dull = Drive(seconds=60.0, basis=SLIP, alpha=ALPHA, speeds=(1.0, 1.0), yaw_rates=(0.4, 0.4))
    windows = learning_windows(prepare_run(simulated_log(dull), "wheel"), "wheel", settings)
    posterior = surface_predictor(method, "wheel", settings, windows).posterior(len(windows))
    std = posterior.prior_std[4:]
    driven, beside = np.array([1.0, 0.4]), np.array([0.4, -1.0]) / std**2  # uncorrelated before any example
    covariance = posterior.covariance[4:, 4:]
    assert driven @ covariance @ driven < 0.01 * driven @ np.diag(std**2) @ driven
    assert beside @ covariance @ beside == pytest.approx(beside @ np.diag(std**2) @ beside, rel=1e-6)


@pytest.mark.parametrize("method", [*LINEAR, PROCESS])
def test_one_window_is_enough_to_go_on(method: str) -> None:
    needs_scikit_learn(method)
    log = simulated_log(Drive(seconds=3.2, basis=SLIP, alpha=ALPHA, speeds=(0.8, 1.2)))
    windows = learning_windows(prepare_run(log, "command"), "command", SETTINGS)
    assert len(windows) == 1
    result = judged(log, (method,))
    assert all(np.isfinite(p.pose).all() and np.isfinite(p.nis).all() for p in result.predictions)
    posterior = surface_predictor(method, "command", SETTINGS, windows).posterior(1)
    assert (np.linalg.eigvalsh(posterior.covariance) >= -1e-12).all()


def test_before_any_window_there_is_no_slip() -> None:
    windows = learning_windows(prepare_run(slipping(), "command"), "command", SETTINGS)
    posterior = surface_predictor("surface-bayesian", "command", SETTINGS, windows).posterior(0)
    assert not posterior.mean[: SLIP.size].any()
    assert (posterior.variance_ratio[: SLIP.size] == 1.0).all()


def test_nothing_learned_is_ever_unlearned() -> None:
    windows = learning_windows(prepare_run(slipping(), "command"), "command", SETTINGS)
    predictor = surface_predictor("surface-least-squares", "command", SETTINGS, windows)
    predictor.posterior(5)
    with pytest.raises(ValueError, match="is gone"):
        predictor.posterior(4)


def test_without_scikit_learn_the_gaussian_process_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.gaussian_process", None)
    with pytest.raises(SettingsError, match=r"needs scikit-learn.*pip install"):
        judged(slipping(), (PROCESS,))
    assert judged(slipping(), ("surface-bayesian",)).scores


def test_a_long_log_says_aloud_that_the_process_takes_a_part_of_it(caplog: pytest.LogCaptureFixture) -> None:
    needs_scikit_learn(PROCESS)
    log = simulated_log(Drive(seconds=300.0, basis=SLIP, alpha=ALPHA))
    windows = learning_windows(prepare_run(log, "wheel"), "wheel", SETTINGS)
    predictor = surface_predictor(PROCESS, "wheel", SETTINGS, windows)
    predictor.posterior(len(windows))
    said = [
        record.getMessage() for record in caplog.records if "spread over the drives" in record.getMessage()
    ]
    assert said == [f"{PROCESS} keeps 200 examples, spread over the drives"]
