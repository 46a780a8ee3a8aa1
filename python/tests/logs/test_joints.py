# SPDX-License-Identifier: Apache-2.0
"""Wheel speeds from joint states: measured, or differences of angles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from sample_bags import EPOCH, JOINT_STATE, SECOND, Bag, drive_along_x

from slipwise.errors import LogError
from slipwise.logs import Inputs, LogOptions, open_log
from slipwise.logs.joints import SideMotion, sides_text, speeds_from_angles

WHEELS = ["left_wheel", "right_wheel"]
SIZES = LogOptions(wheel_radius=0.1, wheel_separation=0.5)


@dataclass
class State:
    """A JointState as far as it is looked at."""

    name: list[str]
    position: list[float]
    velocity: list[float]


def bag_with_joints(folder: Path, speeds: list[float] | None, *, wrap: bool = False) -> Path:
    """Wheels at 2 and 4 rad/s beside a drive along x."""
    bag = drive_along_x(Bag())
    for k in range(100):
        stamp = EPOCH + k * SECOND // 10
        angles = [0.2 * k, 0.4 * k]
        if wrap:
            angles = [float(np.arctan2(np.sin(angle), np.cos(angle))) for angle in angles]
        bag.add(stamp, "/joint_states", JOINT_STATE, bag.joints(stamp, WHEELS, angles, speeds or []))
    return bag.write(folder / "a.mcap")


def wheels_of(path: Path) -> Inputs:
    wheels = open_log(path, options=SIZES).runs[0].wheels
    assert wheels is not None
    return wheels


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize("speeds", [None, [0.0, 0.0]])
def test_angles_alone_are_differentiated(tmp_path: Path, speeds: list[float] | None, wrap: bool) -> None:
    path = bag_with_joints(tmp_path, speeds, wrap=wrap)
    wheels = wheels_of(path)
    np.testing.assert_allclose(wheels.v, 0.3, atol=1e-6)
    np.testing.assert_allclose(wheels.omega, 0.4, atol=1e-6)
    assert len(wheels) == 100
    notes = open_log(path, options=SIZES).notes
    assert "/joint_states has no wheel speeds: they are differences of its positions" in notes


def test_measured_speeds_are_taken_as_they_are(tmp_path: Path) -> None:
    wheels = wheels_of(bag_with_joints(tmp_path, [1.0, 3.0]))
    np.testing.assert_allclose(wheels.v, 0.2, atol=1e-12)


def test_joint_states_that_are_not_read_are_named_with_their_wheels(tmp_path: Path) -> None:
    log = open_log(bag_with_joints(tmp_path, [1.0, 3.0]))
    assert log.runs[0].wheels is None
    (note,) = (note for note in log.notes if "joint" in note)
    assert "--wheel-radius and --wheel-separation" in note
    assert "left: left_wheel; right: right_wheel" in note
    assert log.advice == {"wheel": note}


def test_speeds_reach_from_one_angle_to_the_next() -> None:
    t = np.array([0.0, 1.0, 3.0, 3.0])
    speeds = speeds_from_angles(t, np.array([[0.0], [2.0], [3.0], [3.0]]))
    np.testing.assert_allclose(speeds[:2, 0], [2.0, 0.5])
    assert np.isnan(speeds[2:]).all()


def test_angles_are_followed_over_whole_turns_and_no_further() -> None:
    motion = SideMotion(LogOptions())
    angles = [motion(State(WHEELS, [angle, 40.0], []))[2] for angle in (3.0, -3.0, 0.0)]
    np.testing.assert_allclose(angles, [3.0, 2.0 * np.pi - 3.0, 2.0 * np.pi])
    far = SideMotion(LogOptions())
    assert [far(State(WHEELS, [angle, 0.0], []))[2] for angle in (50.0, 54.0)] == [50.0, 54.0]


def test_names_that_do_not_tell_the_sides_ask_for_them() -> None:
    assert "give --left-joints and --right-joints; joints: a, b" in sides_text(("a", "b"), LogOptions())
    motion = SideMotion(LogOptions())
    motion(State(["a", "b"], [], []))
    with pytest.raises(LogError, match="--left-joints"):
        motion.refuse_none()


def test_messages_without_wheels_are_no_reason_to_refuse_those_with_them() -> None:
    motion = SideMotion(LogOptions())
    assert np.isnan(motion(State(["shoulder_pan_joint"], [0.1], [0.2]))).all()
    assert motion(State(WHEELS, [1.0, 2.0], [3.0, 4.0])) == (3.0, 4.0, 1.0, 2.0)
    motion.refuse_none()
    with pytest.raises(LogError, match="no joints of left and right wheels: shoulder_pan_joint"):
        motion.check(State(["shoulder_pan_joint"], [0.1], [0.2]))
