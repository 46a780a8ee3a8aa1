# SPDX-License-Identifier: Apache-2.0
"""Roll and pitch of sensors that sit on the robot in any way, in any turn and unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise.calibration import calibrate
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.errors import LogError
from slipwise.logs import Log
from slipwise.logs.quality import checked

PLAIN = simulated_log(Drive(seconds=40.0))


def tilted(scale: float = 1.0, roll: float = 0.0, pitch: float = 0.0) -> Log:
    """A log of a robot on waves: its roll and pitch times a scale, of a sensor that is mounted so [rad]."""
    (run,) = PLAIN.runs
    waves = 0.05 * np.sin(run.poses.t), 0.04 * np.cos(0.7 * run.poses.t)
    poses = replace(run.poses, roll=scale * waves[0] + roll, pitch=scale * waves[1] + pitch)
    return Log(runs=(replace(run, poses=poses),))


def tilts(log: Log) -> np.ndarray:
    (run,) = log.runs
    assert run.poses.roll is not None
    assert run.poses.pitch is not None
    return np.stack([run.poses.roll, run.poses.pitch])


def test_angles_from_0_to_a_whole_turn_are_those_about_0() -> None:
    log = tilted()
    (run,) = log.runs
    roll, pitch = tilts(log) % (2.0 * np.pi)
    turned = Log(runs=(replace(run, poses=replace(run.poses, roll=roll, pitch=pitch)),))
    np.testing.assert_allclose(tilts(checked(turned)), tilts(log), atol=1e-12)
    one, other = (calibrate(checked(each), input="wheel").model.parameters for each in (log, turned))
    assert all(other[name].value == pytest.approx(one[name].value, abs=1e-9) for name in one)


@pytest.mark.parametrize("roll", [np.pi / 2, -np.pi / 2, np.pi])
def test_a_sensor_on_its_side_or_upside_down_is_put_upright_and_said(roll: float) -> None:
    log = checked(tilted(roll=roll))
    np.testing.assert_allclose(tilts(log), tilts(tilted()), atol=1e-12)
    (note,) = log.notes
    assert "not mounted level" in note
    assert "taken out" in note


def test_of_a_sensor_that_looks_up_no_tilt_is_used_and_its_yaw_is_doubted() -> None:
    log = checked(tilted(pitch=-1.5))
    assert log.runs[0].poses.roll is None
    assert log.runs[0].poses.pitch is None
    assert "its yaw may not be the robot's" in log.notes[0]
    assert {each.kind: each.count for each in log.left_out} == {"steep-attitude": len(log.runs[0].poses)}


def test_a_level_sensor_is_not_spoken_of() -> None:
    assert checked(tilted()).notes == ()


def test_degrees_are_named() -> None:
    with pytest.raises(LogError, match="roll and pitch look like degrees") as caught:
        checked(tilted(scale=57.3))
    assert "convert the poses' angles to radians" in str(caught.value)


def test_a_live_learner_says_the_same_of_the_same_attitudes() -> None:
    log = tilted(roll=np.pi)
    learner = MotionLearner("wheel")
    for t, (roll, pitch) in zip(log.runs[0].poses.t.tolist(), tilts(log).T.tolist(), strict=True):
        learner.push_attitude(t, roll, pitch)
    assert (learner.attitude_mounting,) == checked(log).notes
