# SPDX-License-Identifier: Apache-2.0
"""The known robot does what it says: actuator, clocks, slip and sensor, each alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import held

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs import Inputs, Run
from slipwise_sim.known_robot import KnownRobot, known_run

QUIET = KnownRobot(
    lag=(0.3, 0.2),
    delay=(0.17, 0.1),
    slip_psd=(0.0, 0.0, 0.0),
    pose_std=(0.0, 0.0),
    wheel_std=(0.0, 0.0),
)
STEP = held([0.0], 1.0, 0.4)


def driven(robot: KnownRobot, commands: Inputs = STEP, seconds: float = 4.0) -> Run:
    return known_run(robot, commands, (0.0, seconds), random=np.random.default_rng(1))


def test_a_step_is_answered_after_the_delay_with_the_lag_the_gain_and_the_slow_part() -> None:
    robot = replace(QUIET, gain=(0.9, 1.1), slow_fraction=(0.3, 0.0), slow_time_constant=(1.5, 1.0))
    wheels = driven(robot).wheels
    assert wheels is not None
    late = wheels.t + 0.025 - 0.17  # the middle of each period, since the step arrived
    expected = 0.9 * (0.7 * (1.0 - np.exp(-late / 0.3)) + 0.3 * (1.0 - np.exp(-late / 1.5)))
    np.testing.assert_allclose(wheels.v, np.where(late > 0.03, expected, wheels.v), atol=2e-3)
    assert not wheels.v[wheels.t < 0.1].any()
    assert wheels.omega[-1] == pytest.approx(1.1 * 0.4, rel=1e-4)


def test_holding_the_wheel_speeds_gives_the_path() -> None:
    run = driven(QUIET)
    assert run.wheels is not None
    distance = float(np.sum(run.wheels.v) * 0.05)
    turned = float(np.sum(run.wheels.omega) * 0.05)
    assert run.poses.yaw[-1] == pytest.approx(turned, abs=1e-9)
    length = float(np.sum(np.hypot(np.diff(run.poses.x), np.diff(run.poses.y))))
    assert length == pytest.approx(distance, rel=1e-4)


def test_the_core_predicts_it_by_its_own_chain() -> None:
    rng = np.random.default_rng(4)
    t = np.round(np.arange(0.0, 6.0, 0.05), 6)
    commands = Inputs(
        t=t,
        v=np.repeat(rng.uniform(0.0, 1.0, 6), 20),
        vy=np.zeros(120),
        omega=np.repeat(rng.uniform(-1, 1, 6), 20),
    )
    robot = replace(QUIET, basis=_core.named_basis("edd-2"), slip=(-0.1, -0.3), sensor=(0.8, 0.2, 0.1))
    run = driven(robot, commands, 5.0)
    model = _core.MotionModel(robot.basis, True, False).with_extrinsics(True)
    logs = np.log([*robot.lag, *robot.delay])
    history = _core.InputHistory(commands.t, commands.v, commands.vy, commands.omega)
    segment = _core.Segment(0.0, float(run.poses.t[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    parameters = np.concatenate((robot.slip, logs, robot.sensor))
    predicted = _core.linearize_segment(model, parameters, history, segment).predicted
    first, last = (
        _core.Pose2(float(run.poses.x[k]), float(run.poses.y[k]), float(run.poses.yaw[k])) for k in (0, -1)
    )
    difference = _core.between(first, last).vector() - predicted.vector()
    difference[2] = np.arctan2(np.sin(difference[2]), np.cos(difference[2]))
    np.testing.assert_allclose(difference, 0.0, atol=2e-3)


def test_stamps_are_late_by_the_offsets() -> None:
    run = driven(replace(QUIET, wheels_late=0.2, poses_late=0.1))
    assert run.wheels is not None
    assert run.wheels.t[0] == pytest.approx(0.2)
    assert run.poses.t[0] == pytest.approx(0.3)


def test_noise_has_its_stated_size_and_stands_still_with_the_robot() -> None:
    noisy = replace(QUIET, slip_psd=(1e-3, 1e-3, 1e-3))
    still = driven(noisy, held([0.0], 0.0, 0.0))
    assert not still.poses.x.any()
    spread = np.std(
        [
            known_run(noisy, STEP, (0.0, 2.0), random=np.random.default_rng(seed)).poses.yaw[-1]
            for seed in range(60)
        ]
    )
    assert spread == pytest.approx(np.sqrt(1e-3 * 1.8), rel=0.3)


def test_a_span_without_time_is_refused() -> None:
    with pytest.raises(SettingsError, match="span"):
        known_run(QUIET, STEP, (1.0, 1.0), random=np.random.default_rng(1))
