# SPDX-License-Identifier: Apache-2.0
"""A robot must stop where its button is released or silent, its pose is old or odd, or it leaves its area."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from slipwise.live.drive_guard import DriveBounds, DriveGuard
from slipwise.live.samples import Pose

BOUNDS = DriveBounds(-1.0, 3.0, -2.0, 2.0, speed=1.0, yaw_rate=1.0)
START = Pose(100.0, 5.0, 7.0, math.pi / 2.0, frame="map")


class Clock:
    """Seconds that a test counts."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def driving(start: Pose = START) -> tuple[DriveGuard, Clock]:
    clock = Clock()
    guard = DriveGuard(BOUNDS, clock=clock)
    guard.take_dead_man(True)
    guard.take_pose(start)
    guard.stand()
    guard.begin()
    assert guard.trouble() == ""
    return guard, clock


def later(seconds: float, **moved: float) -> Pose:
    return replace(START, t=START.t + seconds, **moved)


def test_before_the_drive_it_says_what_is_missing() -> None:
    clock = Clock()
    guard = DriveGuard(BOUNDS, clock=clock)
    assert guard.not_ready() == "a pose"
    guard.take_pose(START)
    assert "dead man" in guard.not_ready()
    guard.take_dead_man(True)
    assert guard.not_ready() == ""
    clock.now = 0.4
    assert "dead man" in guard.not_ready()
    clock.now = 0.6
    assert "old" in guard.not_ready()
    assert not guard.wake.is_set()  # nothing drives yet


def test_a_released_button_stops_at_once_and_for_good() -> None:
    guard, clock = driving()
    clock.now = 0.1
    guard.take_dead_man(False)
    assert guard.wake.is_set()
    assert guard.caused_at == 0.1
    guard.take_dead_man(True)
    assert guard.trouble() == "the dead man's button was released"


def test_a_silent_button_stops() -> None:
    guard, clock = driving()
    clock.now = 0.3
    guard.take_pose(later(0.3))
    assert guard.trouble() == "nothing is heard of the dead man's button"


@pytest.mark.parametrize("pose", [None, START, later(-1.0), later(0.6, x=math.nan)])
def test_poses_that_are_missing_or_repeated_or_none_stop(pose: Pose | None) -> None:
    guard, clock = driving()
    clock.now = 0.6
    guard.take_dead_man(True)
    if pose is not None:
        guard.take_pose(pose)
    assert guard.trouble() == "no pose comes"


def test_the_area_is_seen_from_the_start_along_its_heading() -> None:
    for seen, inside in (((2.9, 1.9), True), ((-0.9, -1.9), True), ((3.1, 0.0), False), ((0.0, 2.1), False)):
        guard, _ = driving()
        x, y = START.x - seen[1], START.y + seen[0]  # the start faces along y
        for part in (0.25, 0.5, 0.75, 1.0):
            where = (START.x + part * (x - START.x), START.y + part * (y - START.y))
            guard.take_pose(later(part, x=where[0], y=where[1]))
        assert (guard.trouble() == "") == inside
        assert guard.room_left == pytest.approx(0.1 if inside else -0.1)


def test_a_pose_that_jumps_or_changes_its_frame_stops() -> None:
    guard, _ = driving()
    guard.take_pose(later(0.1, x=START.x + 0.9))
    assert "jumped by 0.90 m" in guard.trouble()
    guard, _ = driving()
    guard.take_pose(replace(later(0.1), frame="odom"))
    assert "frame" in guard.trouble()


def test_a_robot_that_moved_does_not_stand() -> None:
    guard, _ = driving()
    assert guard.stands()
    guard.take_pose(later(0.1, x=START.x + 0.2))
    assert not guard.stands()
