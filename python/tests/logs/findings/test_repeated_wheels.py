# SPDX-License-Identifier: Apache-2.0
"""Poses that integrate the wheels are found however they do it; poses of a sensor or a simulator are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, circular, sound_log, with_poses
from sample_logs import poses_of, simulated_run

from slipwise import _core
from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.repeated_wheels import RepeatedWheels
from slipwise.logs.findings.seen import AT_CENTRE, Seen
from slipwise.logs.motion_windows import evidence_of


def found_in(pairs: list[tuple[Inputs, Poses]]) -> Finding | None:
    """Look for it in runs of wheels and poses."""
    evidence = evidence_of([Run("run", None, wheels, poses) for wheels, poses in pairs], 0.5)
    seen = Seen(evidence, ["run"], "wheel", positions=False, gyro=False, sensor=AT_CENTRE)
    return RepeatedWheels().look(seen)


def pairs(log: Log) -> list[tuple[Inputs, Poses]]:
    return [(run.wheels, run.poses) for run in log.runs if run.wheels is not None]


def odometry(rate: float, *, at_end: bool, euler: bool) -> list[tuple[Inputs, Poses]]:
    """Poses as an odometry node integrates them: with the twist of each message, or the one before."""
    wheels = simulated_run(SKID_STEERED).wheels
    assert wheels is not None
    t = np.arange(0.0, wheels.t[-1], 1.0 / rate)
    v, omega = (np.interp(t, wheels.t, column) for column in (wheels.v, wheels.omega))
    used = slice(1, None) if at_end else slice(None, -1)
    turns = omega[used] / rate
    yaw = np.concatenate(([0.0], np.cumsum(turns)))
    along = yaw[:-1] + (0.0 if euler else 0.5) * turns
    x, y = (np.concatenate(([0.0], np.cumsum(v[used] / rate * f(along)))) for f in (np.cos, np.sin))
    return [(Inputs(t=t, v=v, vy=np.zeros_like(t), omega=omega), poses_of(t, np.column_stack((x, y, yaw))))]


def test_odometry_is_found_however_it_integrates(subtests: pytest.Subtests) -> None:
    for rate in [20.0, 50.0]:
        for at_end in [False, True]:
            for euler in [False, True]:
                with subtests.test(rate=rate, at_end=at_end, euler=euler):
                    found = found_in(odometry(rate, at_end=at_end, euler=euler))
                    assert found is not None
                    assert "carry no information of their own" in found.sentence


def test_odometry_on_a_clock_of_its_own_is_found() -> None:
    late = with_poses(circular(sound_log()), lambda p: replace(p, t=p.t + 0.137))
    assert found_in(pairs(late)) is not None


@pytest.mark.parametrize("slip", [(-0.01, -0.01), (0.0, -0.01), (-0.01, 0.0), (0.0, -0.4)])
def test_perfect_poses_of_a_simulator_whose_robot_slips_are_its_own(slip: tuple[float, float]) -> None:
    drive = replace(SKID_STEERED, alpha=slip, pose_std=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0))
    assert found_in(pairs(sound_log(drive))) is None


def test_the_best_of_sensors_on_a_robot_that_does_not_slip_is_no_repetition() -> None:
    drive = replace(
        SKID_STEERED,
        basis=_core.Basis("none", [], [], []),
        alpha=(),
        pose_std=(0.0005, 0.0005),
        slip_psd=(0.0, 0.0, 0.0),
    )
    assert found_in(pairs(sound_log(drive))) is None


def test_nothing_is_said_of_too_few_windows() -> None:
    wheels, poses = odometry(20.0, at_end=False, euler=False)[0]
    assert found_in([(wheels.select(slice(0, 25)), poses)]) is None
    assert found_in([]) is None
