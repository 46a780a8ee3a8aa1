# SPDX-License-Identifier: Apache-2.0
"""How well an offset of clocks can be known at most: wheel speeds are samples, held until the next one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief

OFFSET = "clock_offset"


class StampSpacing:
    """How far apart the wheel speeds are stamped."""

    def __init__(self, windows: WindowSet) -> None:
        """`windows` are those learned from."""
        logged = [run.inputs if run.wheels is None else run.wheels for run in windows.drive]
        intervals = [np.diff(inputs.t) for inputs in logged if len(inputs) > 1]
        self.seconds = float(np.median(np.concatenate(intervals))) if intervals else 0.0

    def supported(self, belief: Belief, count: int) -> Belief:
        """Return the belief after `count` windows with a clock offset no surer than the stamps support.

        Between two samples it is not known when the wheels changed their speed: each change says when only to
        within the spacing, evenly spread. Residuals hide that where poses and wheels are of one source.
        """
        names = [info.name for info in belief.motion.parameters]
        if OFFSET not in names or count == 0:
            return belief
        place, least = names.index(OFFSET), self.seconds / np.sqrt(12.0 * count)
        std = float(np.sqrt(belief.covariance[place, place]))
        if not 0.0 < std < least:
            return belief
        wider = np.ones(len(names))
        wider[place] = least / std
        covariance, ratio = belief.covariance * np.outer(wider, wider), belief.variance_ratio * wider**2
        return replace(belief, covariance=covariance, variance_ratio=ratio)
