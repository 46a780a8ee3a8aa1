# SPDX-License-Identifier: Apache-2.0
"""Notices that two robots speak on one topic: values go back and forth between two courses."""

from __future__ import annotations

from collections import deque

import numpy as np

from slipwise.live.outputs import Floats

REMEMBERED = 5  # values that a new one is compared with
LOOKED_AT = 40  # newest values that returns are counted in
MANY = 6  # returns among these; an outlier is one return
CLOSED_FOR = 5.0  # s after the last return


class SourceWatch:
    """A value far from the last one, yet near an earlier one, is a return: rare where one source speaks.

    Args:
        far: how far apart values of one source, sampled one after the other, never are, [K] in its units.
    """

    def __init__(self, far: tuple[float, ...]) -> None:
        self._far = np.array(far)
        self._last: deque[Floats] = deque(maxlen=REMEMBERED)
        self._returns: deque[bool] = deque(maxlen=LOOKED_AT)
        self._until = -np.inf

    def take(self, t: float, values: tuple[float, ...]) -> bool:
        """Take a value [K] at its stamp [s]; return whether two sources speak now."""
        value = np.array(values)
        if not np.isfinite(value).all():
            return t < self._until
        self._returns.append(self._is_return(value))
        self._last.append(value)
        if self._returns[-1] and sum(self._returns) >= MANY:
            self._until = t + CLOSED_FOR
        return t < self._until

    def _is_return(self, value: Floats) -> bool:
        if len(self._last) < 2:
            return False
        apart = [float(np.max(np.abs(value - old) / self._far)) for old in self._last]
        return apart[-1] > 1.0 and min(apart[:-1]) < 1.0 / 3.0
