# SPDX-License-Identifier: Apache-2.0
"""Whether inputs drive a robot sideways, from one sample at a time."""

from __future__ import annotations

import math

from slipwise.models.axes import driven_span


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
