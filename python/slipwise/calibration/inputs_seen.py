# SPDX-License-Identifier: Apache-2.0
"""What inputs show one sample at a time: how far apart wheel speeds come, and whether they drive sideways."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.models.axes import driven_span


class WheelStep:
    """The mean time between wheel speeds, gaps left out: a clock offset within that is how they are held.

    Args:
        total: of all steps so far [s].
        count: of the steps.
        last: stamp of the newest wheel speed of the run [s], None before the first.
    """

    def __init__(self, total: float = 0.0, count: int = 0, last: float | None = None) -> None:
        self.total, self.count, self.last = total, count, last

    def take(self, t: float) -> None:
        """Take the stamp of a wheel speed [s]."""
        if not math.isfinite(t):
            return
        step = 0.0 if self.last is None else t - self.last
        if 0.0 < step <= UNKNOWN_AFTER:
            self.total, self.count = self.total + step, self.count + 1
        self.last = t if self.last is None else max(t, self.last)

    def take_run(self, t: NDArray[np.float64]) -> None:
        """Take all stamps of a run [N], which increase; the same as one after the other."""
        steps = np.diff(t)
        steps = steps[steps <= UNKNOWN_AFTER]
        self.total = float(np.add.accumulate(np.concatenate(([self.total], steps)))[-1])
        self.count += len(steps)

    def restart(self) -> None:
        """Another run begins."""
        self.last = None

    @property
    def seconds(self) -> float:
        """The mean [s], 0 where there is none."""
        return round(self.total / self.count, 4) if self.count else 0.0


class SidewaysSeen:
    """The range of sideways speeds so far, and the largest speed.

    Args:
        most: largest speed so far [m/s].
        right: least sideways speed, not above 0 [m/s].
        left: largest sideways speed, not below 0 [m/s].
    """

    def __init__(self, most: float = 0.0, right: float = 0.0, left: float = 0.0) -> None:
        self.most, self.right, self.left = most, right, left

    def take(self, v: float, vy: float) -> None:
        """Take the speeds of an input [m/s]."""
        speed = math.hypot(v, vy)
        if math.isfinite(speed):
            self.most = max(self.most, speed)
            self.right, self.left = min(self.right, vy), max(self.left, vy)

    @property
    def span(self) -> list[float] | None:
        """The range [m/s], as `sideways_span` has it of a log; None: it is no axis of commands."""
        return driven_span(self.most, self.right, self.left)
