# SPDX-License-Identifier: Apache-2.0
"""Looks at stamps as they come: whether the clock was set, and whether they are in seconds."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from slipwise.live.samples import Stamped
from slipwise.logs.clock_steps import AGREE, BACK, ENOUGH
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.readings import FEWEST_STEPS, SLOWEST, NotInSeconds

AHEAD = 60.0  # s ahead of it, after which one stamp alone is held back
_LOOKED_AT = 200  # newest steps


class ClockWatch:
    """Holds suspicious samples back: one odd stamp is a fault, several that agree are a new time."""

    def __init__(self) -> None:
        self.newest = -math.inf
        self._ahead: Stamped | None = None  # far ahead of all others, not confirmed yet
        self._behind: list[Stamped] = []
        self._last: dict[type, float] = {}  # s, newest stamp of each sort of sample
        self.set_back_by: float | None = None  # s, by the last sample; None: the clock goes on
        self.dropped = 0  # stamps that no other agreed with

    def take(self, sample: Stamped) -> list[Stamped]:
        """Return what may be taken now, in the order that it came in."""
        t, self.set_back_by = sample.t, None
        if not math.isfinite(t):
            return [sample]  # the learner rejects and counts it
        if t < self.newest - BACK:
            return self._take_behind(sample)
        if self._behind:
            self.dropped += len(self._behind)
            self._behind = []
        if math.isfinite(self.newest) and t > self.newest + AHEAD:
            return self._take_ahead(sample)
        if self._ahead is not None:
            self.dropped += 1
            self._ahead = None
        self.newest = max(self.newest, t)
        self._last[type(sample)] = t
        return [sample]

    def restart(self) -> None:
        """Another recording begins: stamps may start anywhere."""
        self.newest, self._ahead, self._behind, self._last = -math.inf, None, [], {}

    def _take_behind(self, sample: Stamped) -> list[Stamped]:
        """Several in a row that agree with each other are a clock that was set back."""
        if self._behind and abs(sample.t - self._behind[-1].t) > AGREE:
            self.dropped += len(self._behind)
            self._behind = []
        self._behind.append(sample)
        if len(self._behind) < ENOUGH:
            return []
        kept, self._behind = self._behind, []
        first = {type(each): each.t for each in reversed(kept)}
        self.set_back_by = max(self._last.get(sort, self.newest) - t for sort, t in first.items())
        self._last = {type(each): each.t for each in kept}
        self.newest = max(each.t for each in kept)
        return kept

    def _take_ahead(self, sample: Stamped) -> list[Stamped]:
        first = self._ahead
        if first is None or abs(sample.t - first.t) > AGREE:
            self.dropped += first is not None
            self._ahead = sample
            return []
        self._ahead = None
        self.newest = max(first.t, sample.t)
        return [first, sample]


class PoseSteps:
    """Keeps how far the newest poses are apart: stamps not in seconds are found as in a whole log."""

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
