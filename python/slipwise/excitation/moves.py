# SPDX-License-Identifier: Apache-2.0
"""Moves: commands held for a time; and figures of them that end where they began, mirrored left and right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Signs of (speed, yaw rate) of the four moves with one command: out and back, then the mirror image out and
#: back. Every slip term is odd or even in them, so that the robot ends with the heading that it began with
#: whatever its slip is; the orders differ in where the remaining displacement points.
ORDERS: tuple[tuple[tuple[int, int], ...], ...] = tuple(
    ((a, b), (-a, -b), (c, -c * a * b), (-c, c * a * b)) for a in (1, -1) for b in (1, -1) for c in (1, -1)
)


@dataclass(frozen=True)
class Move:
    """One command, held, and standing still after it."""

    v: float  # m/s
    omega: float  # rad/s
    hold: float  # s
    pause: float  # s
    vy: float = 0.0  # m/s, to the left, of a robot that drives sideways

    @property
    def seconds(self) -> float:
        """How long it takes with the pause [s]."""
        return self.hold + self.pause


def figure_of(
    commands: Sequence[Sequence[float]], order: Sequence[tuple[int, int]], hold: float, pause: float
) -> list[Move]:
    """Return the moves of a figure: each command out and back, then each one's mirror image out and back.

    Args:
        commands: speed [m/s] and yaw rate [rad/s], not negative; one or two. Where a sideways speed [m/s]
            stands between them, it changes its sign with the yaw rate: so does its mirror image.
        order: one of ORDERS.
        hold: how long each command is held [s].
        pause: how long the robot stands after it [s].
    """
    return [
        Move(a * v + 0.0, b * omega + 0.0, hold, pause, b * sum(vy) + 0.0)
        for pair in (order[:2], order[2:])
        for v, *vy, omega in commands
        for a, b in pair
    ]


def command_periods(moves: Sequence[Move], period: float) -> Floats:
    """Return the moves as commands (v, vy, omega) [K, 3], each for one period [s].

    Hold and pause are multiples of it.
    """
    rows, periods = [], []
    for move in moves:
        rows += [(move.v, move.vy, move.omega), (0.0, 0.0, 0.0)]
        periods += [round(move.hold / period), round(move.pause / period)]
    return np.repeat(np.array(rows, np.float64).reshape(-1, 3), np.array(periods, np.int64), axis=0)


def start_times(moves: Sequence[Move], first: float) -> Floats:
    """Return when each move begins [N] and the last one's pause ends, [N + 1] s."""
    return first + np.concatenate(([0.0], np.cumsum([move.seconds for move in moves])))
