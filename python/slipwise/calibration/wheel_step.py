# SPDX-License-Identifier: Apache-2.0
"""How far apart wheel speeds come: an offset of clocks within that is how they are held."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.held import UNKNOWN_AFTER


class WheelStep:
    """The mean time between wheel speeds, gaps left out.

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
