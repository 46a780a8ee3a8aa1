# SPDX-License-Identifier: Apache-2.0
"""Estimators by name: what they learn, from which windows, and in what order."""

from __future__ import annotations

import numpy as np
import pytest

import slipwise as sw
from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.estimator_run import EstimatorRun
from slipwise.calibration.prepared_run import WindowSet, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs, Log, Poses, Run
from slipwise_thesis import _thesis
from slipwise_thesis.estimator_run import run_estimator
from slipwise_thesis.estimators import (
    estimator_basis,
    estimator_learner,
    estimator_motion,
    fed_windows,
)

SLIP = np.array([-0.1, -0.3])  # edd-2


def circling_log() -> Log:
    """Two minutes of changing circles, poses at 20 Hz, slip in proportion to both speeds."""
    t = np.arange(0.0, 120.0, 0.05)
    v = 1.0 + 0.5 * np.sign(np.sin(0.4 * t))
    omega = 0.6 * np.sign(np.sin(0.23 * t + 0.5))
    pose, poses = _core.Pose2(0.0, 0.0, 0.0), []
    for speed, rate in zip(v.tolist(), omega.tolist(), strict=True):
        poses.append(pose.vector())
        tangent = np.array([speed * (1.0 + SLIP[0]), 0.0, rate * (1.0 + SLIP[1])]) * 0.05
        pose = _core.compose(pose, _core.exp(tangent))
    x, y, yaw = np.array(poses).T
    rng = np.random.default_rng(5)
    x, y, yaw = (column + 0.003 * rng.standard_normal(len(t)) for column in (x, y, yaw))
    wheels = Inputs(t=t, v=v, vy=np.zeros_like(t), omega=omega)
    seen = Poses(t=t, x=x, y=y, yaw=yaw, frame=np.zeros(len(t), dtype=np.int64))
    return Log(runs=(Run(name="circles", commands=None, wheels=wheels, poses=seen),))


@pytest.fixture(scope="module")
def settings() -> Settings:
    return make_settings({"basis": "edd-2", "learn_clock_offset": False})


@pytest.fixture(scope="module")
def windows(settings: Settings) -> WindowSet:
    return learning_windows(prepare_run(circling_log(), "wheel"), "wheel", settings)


def run_of(name: str, settings: Settings, windows: WindowSet) -> EstimatorRun:
    return run_estimator(settings.model_copy(update={"estimator": name}), "wheel", windows)


def test_what_batch_knew_on_the_way_never_depends_on_what_came_later(
    settings: Settings, windows: WindowSet
) -> None:
    one, other = (run_of("batch", settings, windows) for _ in range(2))
    early = one.posterior(20)
    one.kept()
    assert np.array_equal(early.mean, other.posterior(20).mean)


def test_every_estimator_calibrates(subtests: pytest.Subtests) -> None:
    for name in _thesis.estimator_names():
        with subtests.test(name=name):
            chosen = make_settings({"basis": "edd-2", "learn_clock_offset": False, "estimator": name})
            calibration = calibrate(circling_log(), settings=chosen)
            assert calibration.verdict.good
            assert calibration.model.mean == pytest.approx(SLIP, abs=0.01)
            assert calibration.model.content.provenance.settings["estimator"] == name
            if name == "batch":
                assert calibration.history is None
            else:
                assert calibration.history.mean[-1] == pytest.approx(calibration.model.mean, abs=1e-12)


def test_the_estimator_and_smoothing_are_options_of_the_package() -> None:
    result = sw.calibrate(circling_log(), basis="edd-2", estimator="delayed-state", smooth=True)
    assert result.model.content.provenance.settings == {"basis": "edd-2", "estimator": "delayed-state"}
    assert result.smoothed is not None
    with pytest.raises(SettingsError, match="unknown estimator 'magic'"):
        sw.calibrate(circling_log(), estimator="magic")


def test_an_estimator_that_does_not_exist_is_refused_with_those_that_do() -> None:
    with pytest.raises(SettingsError, match=r"estimator: .*unknown estimator 'magic'; known are average, "):
        make_settings({"estimator": "magic"})

    # Means that agree after each segment have had the same gains; the covariance that the average
    # reports also holds what residuals say of the noise model.


def test_thesis_estimators_see_overlapping_windows_but_none_that_ends_later(
    settings: Settings, windows: WindowSet
) -> None:
    motion = estimator_motion("ekf-thesis", settings, "wheel")
    learner = estimator_learner("ekf-thesis", motion, settings)
    thesis = CausalPass(learner, fed_windows("ekf-thesis", settings, windows), pace=windows)
    at = int(np.searchsorted(windows.end, 10.0))
    assert (thesis.posterior(0).mean == 0.0).all()
    thesis.posterior(at)
    assert thesis.learned == pytest.approx((windows.end[at - 1] - 5.0) / 0.05 + 1.0, abs=1.0)
    with pytest.raises(ValueError, match="is gone"):
        thesis.posterior(at - 1)


def test_basis_is_that_of_the_settings_and_thesis_estimators_have_no_lag() -> None:
    assert estimator_basis(Settings()) == "odd-even-10"
    assert estimator_basis(make_settings({"basis": "drive-5"})) == "drive-5"
    assert estimator_motion("delayed-state", Settings(), "command").size == 14
    assert estimator_motion("ekf-thesis", Settings(), "command").size == 10
    assert estimator_motion("iekf", Settings(), "wheel").clock_offset
