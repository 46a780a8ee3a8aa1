# SPDX-License-Identifier: Apache-2.0
"""Stamps of messages: those of their headers; messages without one are dated by the clock of the others."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

LOOKED_AT = 200  # messages with a header, of late
APART = 10.0  # s between header and arrival, from which on the headers run on a clock of their own


class Stamps:
    """Dates messages [s]."""

    def __init__(self) -> None:
        self.simulated = False  # whether /clock gives the time
        self._now = float("nan")  # s, of /clock
        self._ahead: deque[float] = deque(maxlen=LOOKED_AT)  # s, header minus arrival

    def take_clock(self, clock: Any) -> None:
        """Take the time that /clock has."""
        self._now = clock.sec + clock.nanosec / 1e9

    def of(self, message: Any, arrived: float) -> float:
        """Return the stamp of a message that arrived at a time [s since 1970].

        Without a header it is the time of /clock; else that of arrival, on the clock of the headers where
        these differ: the least delayed of them says by how much.
        """
        header = getattr(message, "header", None)
        if header is not None and (header.stamp.sec or header.stamp.nanosec):
            t = float(header.stamp.sec + header.stamp.nanosec / 1e9)
            self._ahead.append(t - arrived)
            return t
        if self.simulated:
            return self._now
        offset = max(self._ahead) if self._ahead else 0.0
        return arrived + (offset if abs(float(np.median(self._ahead or [0.0]))) > APART else 0.0)
