# SPDX-License-Identifier: Apache-2.0
"""Windows of motion: poses against the integrals of the inputs between them."""

import numpy as np
import pytest

from slipwise.logs.log import Inputs, Poses, Run
from slipwise.logs.motion_windows import MotionWindows, evidence_of, motion_windows, wrapped

UNKNOWN_AFTER = 0.5


def windows_of(*pairs: tuple[Inputs, Poses]) -> MotionWindows:
    """Cut runs of commands and poses."""
    runs = [Run(str(k), inputs, None, poses) for k, (inputs, poses) in enumerate(pairs)]
    return motion_windows(evidence_of(runs, UNKNOWN_AFTER).windows, "command")


def inputs(t: np.ndarray, v: float = 1.0, omega: float = 0.2) -> Inputs:
    return Inputs(t=t, v=np.full(len(t), v), vy=np.zeros(len(t)), omega=np.full(len(t), omega))


def poses(t: np.ndarray, frame: np.ndarray | None = None) -> Poses:
    """Of a robot that drives a circle at 1 m/s and 0.2 rad/s; the heading is wrapped."""
    yaw = 0.2 * t
    codes = np.zeros(len(t), np.int64) if frame is None else frame
    return Poses(t=t, x=5.0 * np.sin(yaw), y=5.0 * (1.0 - np.cos(yaw)), yaw=wrapped(yaw), frame=codes)


def test_each_window_holds_what_was_driven_and_what_was_commanded() -> None:
    t = np.arange(0.0, 60.0, 0.1)
    windows = windows_of((inputs(t), poses(t)))
    assert len(windows) >= 36
    np.testing.assert_allclose(windows.forward, windows.duration)
    np.testing.assert_allclose(windows.turn, 0.2 * windows.duration)  # past half turns, too
    np.testing.assert_allclose(windows.rotation, windows.turn)
    np.testing.assert_allclose(windows.distance, 10.0 * np.sin(0.1 * windows.duration))
    np.testing.assert_allclose(windows.sideways, 0.0, atol=1e-12)


def test_no_window_spans_two_frames() -> None:
    t = np.arange(0.0, 20.0, 0.1)
    frame = (t >= 10.05).astype(np.int64)
    there = poses(t, frame)
    jumped = Poses(t=t, x=there.x + 100.0 * frame, y=there.y, yaw=there.yaw, frame=frame)
    windows = windows_of((inputs(t), jumped))
    assert len(windows) >= 10
    assert windows.distance.max() < 3.0


def test_no_window_is_where_inputs_are_unknown() -> None:
    t = np.arange(0.0, 30.0, 0.1)
    known = t[(t < 10.0) | (t > 20.0)]
    whole = windows_of((inputs(t), poses(t)))
    windows = windows_of((inputs(known), poses(t)))
    assert 0 < len(windows) < 0.75 * len(whole)
    np.testing.assert_allclose(windows.forward, windows.duration, rtol=0.5)


def test_runs_are_joined_and_those_of_one_pose_have_no_window() -> None:
    t = np.arange(0.0, 20.0, 0.1)
    one = windows_of((inputs(t), poses(t)))
    both = windows_of((inputs(t), poses(t)), (inputs(t), poses(t[:1])), (inputs(t), poses(t)))
    assert len(both) == 2 * len(one)
    assert both.run.max() == 2
    np.testing.assert_allclose(both.since, np.tile(one.since, 2))
    assert len(windows_of()) == 0


def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(subtests: pytest.Subtests) -> None:
    for angle in [-9.0, -3.2, 0.0, 3.0, 3.2, 100.0]:
        with subtests.test(angle=angle):
            short = wrapped(np.array([angle]))[0]
            assert -np.pi <= short < np.pi
            assert np.cos(short) == pytest.approx(np.cos(angle))
            assert np.sin(short) == pytest.approx(np.sin(angle), abs=1e-12)
            assert wrapped(np.array([370.0]), 360.0)[0] == pytest.approx(10.0)
