# SPDX-License-Identifier: Apache-2.0
"""Terms of gravity are tried where the ground slopes, found there, and called unknown elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log
from sample_noise import lasting_noise
from sample_slopes import Hills, hilly_log

from slipwise.calibration import calibrate
from slipwise.calibration.coming import Coming
from slipwise.calibration.learning_tables import AUTO_BASES
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.settings import Settings, make_settings
from slipwise.calibration.settings_for_log import (
    SIDEWAYS_BASES,
    SLOPE_BASES,
    for_the_ground_of,
    has_attitude,
)
from slipwise.logs.log import Inputs, Log, Run, empty_poses

GRAVITY_TERMS = ("lon.gx", "lat.gy", "ang.gy")
_DEGREE = np.radians(1.0)


def test_only_auto_on_a_log_with_an_attitude_tries_gravity() -> None:
    hilly, flat = hilly_log(1, Hills(seconds=10.0)), simulated_log(Drive(seconds=10.0))
    auto = make_settings({})
    assert for_the_ground_of(hilly, auto).auto.bases == [*AUTO_BASES, *SLOPE_BASES]
    for settings in ({"basis": "edd-2"}, {"auto": {"bases": ["edd-2"]}}):
        chosen = make_settings(settings)
        assert for_the_ground_of(hilly, chosen) is chosen
    assert for_the_ground_of(flat, auto) is auto


def test_an_attitude_of_zeros_or_of_nothing_was_never_measured() -> None:
    run = simulated_log(Drive(seconds=10.0)).runs[0]
    for angle in (0.0, np.nan):
        column = np.full(len(run.poses), angle)
        assert not has_attitude(Log((replace(run, poses=replace(run.poses, roll=column, pitch=column)),)))


@pytest.mark.slow
def test_gravity_is_found_on_hills_and_predictions_are_better_for_it() -> None:
    log = hilly_log(3, Hills(seconds=200.0))
    tried = calibrate(log)
    without = calibrate(log, settings=make_settings({"auto": {"bases": list(AUTO_BASES[:-1])}}))
    found = {p.name: p for p in tried.model.content.parameters}
    truth = {"lon.gx": 0.06, "lat.gy": 0.12, "ang.gy": 0.05}
    for name, value in truth.items():
        assert abs(found[name].value - value) < 3.0 * found[name].std
        assert found[name].identifiable
    better, worse = tried.model.content.verdict.held_out, without.model.content.verdict.held_out
    assert better is not None
    assert worse is not None
    assert better.position < 0.6 * worse.position
    assert better.heading < 0.6 * worse.heading


@pytest.mark.slow
@pytest.mark.parametrize(
    ("angle", "said"), [("pitch", "ahead (pitch or force_x)"), ("roll", "to its side (roll or force_y)")]
)
def test_a_robot_that_creeps_uphill_has_an_angle_of_the_other_sign(angle: str, said: str) -> None:
    (run,) = hilly_log(3, Hills(seconds=100.0)).runs
    poses = replace(run.poses, **{angle: -getattr(run.poses, angle)})
    verdict = calibrate(Log((replace(run, poses=poses),))).verdict
    assert not verdict.good
    assert f"creeps uphill or against the known force, {said}." in verdict.sentence
    assert "REP-103" in verdict.advice[0]


@pytest.mark.slow
def test_on_flat_ground_auto_calls_terms_of_gravity_not_identifiable() -> None:
    """Of twenty drives of a minute, at most one may claim to know one: 15 % would be seen by four in five.

    What the attitude has is noise of 0.2 or 0.5 degrees, what drifts, an offset of the sensor or a map that
    lies askew.
    """
    claimed = 0
    for seed in range(20):
        wrong = (0.003 + 0.006 * (seed % 2), *(_DEGREE * (seed // 2 % 4 == kind) for kind in (1, 2, 3)))
        learned = calibrate(_measured_askew(seed, *wrong)).model.content.parameters
        terms = [p for p in learned if p.name.rpartition("*")[2] in ("gx", "gy") or p.name in GRAVITY_TERMS]
        assert len(terms) in (3, 7)  # the structure without lags has fewer bases
        claimed += any(p.identifiable for p in terms)
    assert claimed <= 1


def _measured_askew(seed: int, white: float, drift: float, offset: float, plane: float) -> Log:
    """Return a minute on flat ground; the attitude has errors of these standard deviations [rad]."""
    log = hilly_log(seed, Hills(height=0.0, seconds=60.0, attitude_std=white))
    run, random = log.runs[0], np.random.default_rng(1000 + seed)
    yaw = run.poses.yaw
    assert run.poses.roll is not None
    assert run.poses.pitch is not None
    drifted = drift * lasting_noise(run.poses.t, 10.0, random, 2)
    (roll, pitch), (rise_x, rise_y) = random.normal(size=(2, 2)) * [[offset], [plane]]
    roll += drifted[:, 0] + rise_y * np.cos(yaw) - rise_x * np.sin(yaw)
    pitch += drifted[:, 1] - rise_x * np.cos(yaw) - rise_y * np.sin(yaw)
    poses = replace(run.poses, roll=run.poses.roll + roll, pitch=run.poses.pitch + pitch)
    return Log((replace(run, poses=poses),))


def test_no_prediction_depends_on_an_attitude_that_is_measured_after_its_start() -> None:
    run = hilly_log(5, Hills(seconds=60.0)).runs[0]
    later = run.poses.t > 40.0
    roll, pitch = run.poses.roll, run.poses.pitch
    assert roll is not None
    assert pitch is not None
    tipped = replace(run.poses, roll=np.where(later, -roll, roll), pitch=np.where(later, 0.3, pitch))
    made = [calibrate(Log((each,))).predictions for each in (run, replace(run, poses=tipped))]
    for one, other in zip(*made, strict=True):
        before = one.t_start < 40.0
        assert before.any()
        assert not before.all()
        assert one.pose[before].tobytes() == other.pose[before].tobytes()
        assert one.covariance[before].tobytes() == other.covariance[before].tobytes()
        assert (one.pose[~before] != other.pose[~before]).any()


def test_a_learner_tries_terms_of_gravity_where_an_attitude_is_announced() -> None:
    tilted = Coming(attitude=True)
    plain, remembering = MotionLearner("command"), MotionLearner("command", remember=True, coming=tilted)
    assert plain.settings == Settings()
    assert set(SLOPE_BASES) < set(remembering.settings.auto.bases)
    chosen = Settings().choosing("edd-2", None)
    assert MotionLearner("command", chosen, coming=tilted).settings == chosen


def test_terms_of_sideways_speed_are_tried_where_the_vehicle_drives_so() -> None:
    level = Log(runs=(), sideways=True)
    assert for_the_ground_of(level, Settings()).auto.bases == [*AUTO_BASES, *SIDEWAYS_BASES]
    chosen = make_settings({"basis": "edd-2"})
    assert for_the_ground_of(level, chosen) is chosen


def test_terms_of_sideways_speed_are_tried_where_the_inputs_have_one() -> None:
    t = np.arange(0.0, 10.0, 0.1)
    for aside, more in ((0.3, SIDEWAYS_BASES), (0.01, ())):
        commands = Inputs(t, np.ones_like(t), aside * np.sin(t), np.zeros_like(t))
        log = Log((Run("omni", commands, None, empty_poses()),))
        assert for_the_ground_of(log, Settings()).auto.bases == [*AUTO_BASES, *more]
