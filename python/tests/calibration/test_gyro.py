# SPDX-License-Identifier: Apache-2.0
"""Positions beside a gyro: turns are the gyro's, its bias is learned, and its errors are as large as said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_positions import ANTENNA, BASIS, HORIZONS, SECONDS, SETTINGS, SLIP, commands

from slipwise import _core
from slipwise.calibration.coming import Coming
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.errors import SettingsError
from slipwise.logs import Log, Run
from slipwise.logs.findings.checks import findings_of
from slipwise.segments import recording_of
from slipwise_sim.known_robot import KnownRobot, known_run

BIAS = 0.012  # rad/s


def run_with_gyro(seed: int, *, noise: float = 0.01, scale: float = 1.0) -> Run:
    random = np.random.default_rng(seed)
    robot = KnownRobot(
        lag=(0.2, 0.3),
        delay=(0.1, 0.15),
        basis=BASIS,
        slip=SLIP,
        sensor=ANTENNA,
        pose_std=(0.01, 0.0),
    )
    run = known_run(robot, commands(random), (0.0, SECONDS), random=random)
    t = run.poses.t
    rate = np.diff(np.unwrap(run.poses.yaw)) / np.diff(t) + BIAS + noise * random.standard_normal(len(t) - 1)
    extra = {"t": 0.5 * (t[1:] + t[:-1]), "gyro_z": scale * rate}
    return replace(run, poses=replace(run.poses, course=True), extra=extra)


def learned(run: Run) -> _core.MotionLearner:
    learner = _core.MotionLearner(core_settings(SETTINGS, "wheel", HORIZONS, coming=Coming(positions=True)))
    learner.push(recording_of(run))
    learner.end_run()
    return learner


def test_a_gyro_that_is_learned_from_and_turns_otherwise_makes_no_good_model() -> None:
    for scale, kinds in ((1.0, []), (57.3, ["gyro-turns-otherwise"]), (-1.0, ["gyro-turns-otherwise"])):
        run = run_with_gyro(1, scale=scale)
        learner = MotionLearner("wheel", SETTINGS, coming=Coming(positions=True))
        learner.start_run("live")
        assert run.wheels is not None
        rows = [(t, 0, i) for i, t in enumerate(run.wheels.t)]
        rows += [(t, 1, i) for i, t in enumerate(run.poses.t)]
        rows += [(t, 2, i) for i, t in enumerate(run.extra["t"])]
        for t, stream, i in sorted(rows):
            if stream == 0:
                learner.push_wheels(t, run.wheels.v[i], run.wheels.omega[i])
            elif stream == 1:
                learner.push_position(t, run.poses.x[i], run.poses.y[i])
            else:
                learner.push_gyro(t, run.extra["gyro_z"][i])
        found = learner.contradictions()
        assert [each.kind for each in found] == kinds
        assert all(each.spoils for each in found)


def test_a_sensor_that_no_log_knows_is_refused_with_those_that_there_are() -> None:
    learner = MotionLearner("wheel", SETTINGS, coming=Coming(positions=True))
    learner.start_run("live")
    learner.push_reading(0.0, "gyro_z", 0.1)
    with pytest.raises(SettingsError, match="known are gyro_z"):
        learner.push_reading(0.1, "gyro_x", 0.1)


@pytest.mark.slow
def test_slip_and_bias_are_true_within_their_uncertainty_and_turns_are_known_better() -> None:
    errors, stds, without = [], [], []
    for seed in range(8):
        run = run_with_gyro(seed)
        learner = learned(run)
        bias, std = learner.gyro_bias
        assert abs(bias - BIAS) < 3.0 * std < 0.01
        estimate = learner.model().motion.estimate
        errors.append(estimate.mean[:6] - SLIP)
        stds.append(np.sqrt(np.diag(estimate.covariance))[:6])
        plain = learned(replace(run, extra={})).model().motion.estimate
        without.append(np.sqrt(np.diag(plain.covariance))[:6])
    z = np.array(errors) / np.array(stds)
    assert np.abs(z).max() < 4.0
    assert np.sqrt(np.mean(z**2, axis=0)).max() < 1.7
    assert np.mean(stds, axis=0)[5] < 0.8 * np.mean(without, axis=0)[5]


def test_a_gyro_that_turns_the_other_way_is_left_out_and_said() -> None:
    run = run_with_gyro(1, scale=-1.0)
    assert learned(run).gyro_bias[1] == pytest.approx(0.02, rel=0.1)  # nothing was pushed
    found = findings_of(Log(runs=(run,)), "wheel")
    assert [each.kind for each in found] == ["gyro-turns-otherwise"]
    assert not found[0].spoils
    assert "counter-clockwise" in found[0].advice[0]
    degrees = findings_of(Log(runs=(run_with_gyro(1, scale=57.3),)), "wheel")
    assert [each.kind for each in degrees] == ["gyro-turns-otherwise"]
    assert findings_of(Log(runs=(run_with_gyro(1),)), "wheel") == ()


def test_poses_tell_their_turns_themselves() -> None:
    run = run_with_gyro(1)
    run = replace(run, poses=replace(run.poses, course=False))
    assert learned(run).gyro_bias[0] == 0.0
