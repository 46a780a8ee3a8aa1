# SPDX-License-Identifier: Apache-2.0
"""Notices that the clock was set: one odd stamp is a fault, several that agree are a new time."""

from __future__ import annotations

import math

from slipwise.live.samples import Stamped
from slipwise.logs.clock_steps import AGREE, BACK, ENOUGH

AHEAD = 60.0  # s ahead of it, after which one stamp alone is held back


class ClockWatch:
    """Holds suspicious samples back until others agree with them, or do not."""

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
