# SPDX-License-Identifier: Apache-2.0
"""Finds live that stamps are not in seconds, as it is found of a whole log."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.readings import FEWEST_STEPS, SLOWEST, NotInSeconds

_LOOKED_AT = 200  # newest steps


class PoseSteps:
    """Keeps how far the newest poses are apart."""

    def __init__(self) -> None:
        self._last = math.nan
        self._steps: deque[float] = deque(maxlen=_LOOKED_AT)

    def take(self, t: float) -> None:
        """Take the stamp of a pose [s]; one that is not later than the last says nothing."""
        if t > self._last:
            self._steps.append(t - self._last)
        if not t <= self._last:
            self._last = t

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._last = math.nan

    @property
    def enough(self) -> bool:
        """Whether there are enough of them to say it."""
        return len(self._steps) >= FEWEST_STEPS

    def found(self) -> Finding | None:
        """Say it where no robot is measured so rarely."""
        if max(self._steps, default=0.0) <= SLOWEST:  # as nearly always: no median is above
            return None
        return NotInSeconds.by(np.array(self._steps))
