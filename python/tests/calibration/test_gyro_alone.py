# SPDX-License-Identifier: Apache-2.0
"""Yaw rates and no pose at all: slip of turns is learned, its uncertainty is true, no more is claimed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_positions import BASIS, HORIZONS, SECONDS, SLIP, commands

import slipwise as sw
from slipwise import _core
from slipwise.calibration.coming import Coming
from slipwise.calibration.core_settings import core_settings
from slipwise.logs import Log, Run
from slipwise.logs.log import empty_poses
from slipwise.segments import recording_of
from slipwise_sim.known_robot import KnownRobot, known_run

BIAS = 0.012  # rad/s
SETTINGS = sw.make_settings({"basis": "full-linear-6"})
TURN = slice(4, 6)  # parameters of the turn


def turning_run(seed: int, *, noise: float = 0.005) -> Run:
    """A robot of which a gyro at 20 Hz and its wheels are recorded."""
    random = np.random.default_rng(seed)
    robot = KnownRobot(
        lag=(0.2, 0.3),
        delay=(0.1, 0.15),
        basis=BASIS,
        slip=SLIP,
        pose_std=(0.0, 0.0),
        wheel_std=(0.003, 0.003),
    )
    inputs = commands(random)
    stands = inputs.t % 30.0 > 24.0  # a gyro needs to stand still now and then
    inputs = replace(inputs, v=np.where(stands, 0.0, inputs.v), omega=np.where(stands, 0.0, inputs.omega))
    run = known_run(robot, inputs, (0.0, SECONDS), random=random)
    t = run.poses.t
    turned = np.diff(np.unwrap(run.poses.yaw)) / np.diff(t)
    turned[t[1:] % 30.0 > 26.0] = 0.0  # white slip of a simulated drive that creeps to its end
    rate = turned + BIAS + noise * random.standard_normal(len(t) - 1)
    extra = {"t": 0.5 * (t[1:] + t[:-1]), "gyro_z": rate}
    return replace(run, poses=empty_poses(), extra=extra)


def learned(run: Run) -> _core.MotionLearner:
    learner = _core.MotionLearner(core_settings(SETTINGS, "wheel", HORIZONS, coming=Coming(gyro_alone=True)))
    learner.start_run()
    learner.push(recording_of(run))
    learner.end_run()
    return learner


@pytest.mark.slow
def test_slip_of_turns_is_true_within_its_uncertainty_and_the_rest_stays_as_it_was() -> None:
    errors, stds, normalised = [], [], []
    for seed in range(10):
        learner = learned(turning_run(seed))
        bias, std = learner.gyro_bias
        assert abs(bias - BIAS) < 4.0 * std < 0.01
        posterior = learner.model().motion
        error = (posterior.estimate.mean[:6] - SLIP)[TURN]
        covariance = posterior.estimate.covariance[TURN, TURN]
        errors.append(error)
        stds.append(np.sqrt(np.diag(covariance)))
        normalised.append(error @ np.linalg.solve(covariance, error))
        assert np.array(posterior.variance_ratio)[:4].min() > 0.99
        assert np.allclose(posterior.estimate.mean[:4], 0.0, atol=1e-9)
    z = np.array(errors) / np.array(stds)
    assert np.abs(z).max() < 4.0
    assert np.mean(normalised) / 2.0 < 2.0
    assert np.mean(stds, axis=0)[1] < 0.01


def test_a_gyro_that_turns_the_other_way_is_no_log_to_learn_from() -> None:
    run = turning_run(1)
    run = replace(run, extra={**run.extra, "gyro_z": -run.extra["gyro_z"]})
    with pytest.raises(sw.SlipwiseError):
        sw.calibrate(Log((run,)), input="wheel", settings=SETTINGS)
