# SPDX-License-Identifier: Apache-2.0
"""Poses of a trailer are found with its length; those of robots that turn late, slip or are real are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log, with_poses
from sample_logs import Drive, simulated_log

from slipwise.calibration import calibrate
from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.findings.towed_poses import TowedPoses
from slipwise.logs.log import Floats

STEP = 0.01  # s


def lagged(values: Floats, lag: float) -> Floats:
    """A drive of first order."""
    result, now = np.empty_like(values), 0.0
    for k, value in enumerate(values.tolist()):
        now += (1.0 - np.exp(-STEP / lag)) * (value - now) if lag else value - now
        result[k] = now
    return result


def driven(
    length: float, *, seed: int = 1, hitch: float = 0.0, late: float = 0.0, wheels: bool = True
) -> Log:
    """A robot that turns by 0.8 of its wheels and tows a trailer, on whose axle the poses are.

    Args:
        length: from the hitch to the trailer's axle [m]; 0: the poses are the robot's.
        seed: of the commands and the noise.
        hitch: from the robot's axle to the hitch [m].
        late: lag of the robot's body behind its wheels [s].
        wheels: the log has wheels, otherwise commands.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 150.0, STEP)
    held = np.cumsum(rng.random(len(t)) < STEP / 2.0)
    asked = np.column_stack((rng.uniform(0.2, 1.4, held[-1] + 1), rng.uniform(-0.5, 0.5, held[-1] + 1)))[held]
    wheel = np.column_stack([lagged(column, 0.2) for column in asked.T])
    v, omega = (lagged(column, late) for column in (0.95 * wheel[:, 0], 0.8 * wheel[:, 1]))
    heading, towed = np.cumsum(STEP * omega), np.zeros(len(t))
    if length:
        for k in range(len(t) - 1):
            fold = heading[k] - towed[k]
            pulled = v[k] * np.sin(fold) - hitch * omega[k] * np.cos(fold)
            towed[k + 1] = towed[k] + STEP * pulled / length
    yaw = towed if length else heading
    x = np.cumsum(STEP * v * np.cos(heading)) - hitch * np.cos(heading) - length * np.cos(yaw)
    y = np.cumsum(STEP * v * np.sin(heading)) - hitch * np.sin(heading) - length * np.sin(yaw)
    x, y, yaw = (column[::10] + std * rng.standard_normal(len(t) // 10) for column, std in
                 ((x, 0.01), (y, 0.01), (yaw, 0.003)))  # fmt: skip
    poses = Poses(t=t[::10], x=x, y=y, yaw=yaw, frame=np.zeros(len(x), np.int64))
    sent = (wheel if wheels else asked)[::5]
    inputs = Inputs(t=t[::5], v=sent[:, 0], vy=np.zeros(len(sent)), omega=sent[:, 1])
    return Log(runs=(Run("drive", None if wheels else inputs, inputs if wheels else None, poses),))


def found_in(log: Log) -> Finding | None:
    return TowedPoses().look_at(WholeLog(log, "wheel"))


@pytest.mark.parametrize("length", [0.7, 1.2, 2.0, 3.5])
@pytest.mark.parametrize("wheels", [True, False])
def test_a_trailer_is_found_with_its_length(length: float, wheels: bool) -> None:
    found = found_in(driven(length, wheels=wheels))
    assert found is not None
    assert found.spoils
    assert found.evidence == pytest.approx(length, rel=0.35)


def test_a_hitch_behind_the_axle_hides_no_trailer() -> None:
    assert found_in(driven(1.2, hitch=0.35)) is not None


def test_no_model_of_a_trailer_is_good() -> None:
    for wheels in (True, False):
        verdict = calibrate(driven(2.0, wheels=wheels), input="wheel" if wheels else "command").verdict
        assert not verdict.good
        assert "turn as a trailer does that the robot tows about 2.0 m behind it" in str(verdict)


@pytest.mark.parametrize("late", [0.0, 0.2, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("wheels", [True, False])
def test_a_robot_that_turns_late_is_no_trailer(late: float, wheels: bool) -> None:
    assert found_in(driven(0.0, late=late, wheels=wheels)) is None


def test_robots_that_slip_are_no_trailers() -> None:
    slow = replace(SKID_STEERED, speeds=(0.1, 0.9), disturbance=(0.1, 10.0))
    for drive in (SKID_STEERED, slow, replace(slow, speeds=(1.0, 6.0), yaw_rates=(-0.3, 0.3))):
        for seed in (1, 2):
            assert found_in(sound_log(replace(drive, seconds=150.0, seed=seed))) is None
    assert found_in(simulated_log(Drive(lag=0.8, delay=0.4, speeds=(0.1, 1.5)))) is None


def test_headings_that_were_smoothed_in_time_are_no_trailers() -> None:
    def smoothed(p: Poses) -> Poses:
        return replace(p, yaw=np.convolve(np.pad(p.yaw, (14, 0), mode="edge"), np.ones(15) / 15.0, "valid"))

    assert found_in(with_poses(driven(0.0), smoothed)) is None


def test_positions_are_no_trailers() -> None:
    """Their headings are the direction of the path, which nobody measured."""
    assert found_in(with_poses(driven(2.0), lambda p: replace(p, course=True))) is None
