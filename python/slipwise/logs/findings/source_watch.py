# SPDX-License-Identifier: Apache-2.0
"""Notices that two robots speak on one topic: the values follow two courses in turn."""

from __future__ import annotations

import itertools
import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LOOKED_AT = 40  # newest values
FEWEST = 8  # times that the courses take turns among these; an outlier is two
APART = 5.0  # how many times farther the other course is than the own one, where these are two sources
CLOSED_FOR = 5.0  # s after two sources were seen last


@dataclass
class _Course:
    value: tuple[float, ...]
    number: int  # of the last value on it


@dataclass(frozen=True)
class _Assigned:
    first: bool  # which course it is on
    own: float  # how far from that, in units of `far`
    other: float


class SourceWatch:
    """Puts every value on the nearer of two courses. Noise and outliers make no second one that is apart.

    Args:
        far: how far apart values of one source, sampled one after the other, hardly ever are, [K] each.
        relative: the same as a fraction of the values, where that is more.
    """

    def __init__(self, far: tuple[float, ...], *, relative: float = 0.0) -> None:
        self._far, self._relative = far, relative
        self._courses: list[_Course] = []
        self._assigned: deque[_Assigned] = deque(maxlen=LOOKED_AT)
        self._count = 0
        self._until = -math.inf

    def take(self, t: float, values: tuple[float, ...]) -> bool:
        """Take a value [K] at its stamp [s]; return whether two sources speak now."""
        if all(map(math.isfinite, values)):
            self._count += 1
            self._assign(values)
            if self._assigned and self._assigned[-1].other > 1.0 and self._two():
                self._until = t + CLOSED_FOR
        return t < self._until

    def first(self, t: Floats, rows: Floats) -> float | None:
        """Return the first stamp [s] at which two sources speak, as `take` would say; None where one does.

        Args:
            t: [N] stamps.
            rows: [N, K] finite values. Until one is far from that before it, all are on one course.
        """
        far = np.maximum(self._far, self._relative * np.abs(rows[1:]))
        jumps = np.flatnonzero((np.abs(np.diff(rows, axis=0)) / far > 1.0).any(axis=1))
        if not len(jumps):
            return None
        rest = zip(t[jumps[0] :].tolist(), rows[jumps[0] :].tolist(), strict=True)
        return next((stamp for stamp, row in rest if self.take(stamp, tuple(row))), None)

    def _assign(self, value: tuple[float, ...]) -> None:
        far = [max(least, self._relative * abs(each)) for least, each in zip(self._far, value, strict=True)]
        apart = [
            max(abs(a - b) / most for a, b, most in zip(value, course.value, far, strict=True))
            for course in self._courses
        ]
        if len(apart) < 2 and (not apart or apart[0] > 1.0):
            self._courses.append(_Course(value, self._count))
            return
        nearer = apart.index(min(apart))
        if len(apart) == 2 and apart[nearer] > 1.0:  # near none: it replaces the one that was left longer ago
            nearer = int(self._courses[0].number > self._courses[1].number)
        self._courses[nearer] = _Course(value, self._count)
        if len(apart) == 2:
            self._assigned.append(_Assigned(nearer == 0, apart[nearer], apart[1 - nearer]))

    def _two(self) -> bool:
        """Whether the courses take turns, and each is followed far more closely than the other is near."""
        left = [b.other for a, b in itertools.pairwise(self._assigned) if a.first != b.first]
        if len(left) < FEWEST:
            return False
        own = np.array([each.own for each in self._assigned])
        followed = float(np.quantile(own, 0.9)) <= 0.5
        return followed and bool(np.median(left) > max(2.0, APART * float(np.quantile(own, 0.75))))
