# SPDX-License-Identifier: Apache-2.0
"""Poses that jump: lone ones are dropped, lasting ones start a frame, and what a robot can do is no jump."""

import numpy as np

from slipwise.logs.log import Inputs, Poses
from slipwise.logs.quality import find_jumps

T = np.arange(0.0, 40.0, 0.1)
JUMP = 200  # a pose amid the drive


def driven(speed: float = 1.0) -> Inputs:
    return Inputs(t=T, v=np.full(len(T), speed), vy=np.zeros(len(T)), omega=np.zeros(len(T)))


def straight(*, x: np.ndarray | float = 0.0, yaw: np.ndarray | float = 0.0) -> Poses:
    zero = np.zeros(len(T))
    return Poses(t=T, x=T + x, y=zero, yaw=zero + yaw, frame=np.zeros(len(T), np.int64))


def at(first: int, last: int, value: float) -> np.ndarray:
    moved = np.zeros(len(T))
    moved[first:last] = value
    return moved


def test_a_heading_that_turns_over_is_a_jump_and_one_that_is_wrapped_is_none() -> None:
    turned = find_jumps(straight(yaw=at(JUMP, len(T), np.pi)), driven(), 0.5)
    assert np.flatnonzero(turned.starts).tolist() == [JUMP]
    wrapped = find_jumps(straight(yaw=at(JUMP, len(T), 2.0 * np.pi)), driven(), 0.5)
    assert not wrapped.starts.any()
    assert not wrapped.dropped.any()


def test_a_step_that_the_commanded_speed_explains_is_no_jump() -> None:
    step = at(JUMP, len(T), 2.5)  # poses that come a second late
    assert not find_jumps(straight(x=step), driven(1.5), 0.5).starts.any()
    assert find_jumps(straight(x=step), driven(0.1), 0.5).starts.any()
