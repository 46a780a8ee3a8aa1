# SPDX-License-Identifier: Apache-2.0
"""Whether a log's ground slopes enough to try slip terms of gravity, and the settings that then do."""

from __future__ import annotations

import math

import numpy as np

from slipwise.calibration.settings import AUTO_BASES, Settings
from slipwise.logs.log import Log

#: Bases with terms of gravity that `auto` averages too where the ground slopes.
SLOPE_BASES = ("odd-even-13", "drive-9")
LEAST_SPREAD = math.radians(1.5)  # of roll and pitch together; a suspension alone moves a robot by less


def tilt_spread(log: Log) -> float:
    """Return how much roll and pitch vary in a log: root of the sum of both variances [rad].

    A sensor that is mounted with a tilt, or a floor that leans one way under a robot that never turns, does
    not vary: there is nothing to learn of gravity.
    """
    rows = [
        np.column_stack((run.poses.roll, run.poses.pitch))
        for run in log.runs
        if run.poses.roll is not None and run.poses.pitch is not None
    ]
    tilts = np.concatenate(rows) if rows else np.empty((0, 2))
    tilts = tilts[np.isfinite(tilts).all(axis=1)]
    return float(np.sqrt(tilts.var(axis=0).sum())) if len(tilts) else 0.0


def for_the_ground_of(log: Log, settings: Settings) -> Settings:
    """Return the settings with which a log is learned: with terms of gravity where its ground slopes.

    Only the default list of `auto` is extended; bases that were chosen stay as they are.
    """
    default = settings.basis == "auto" and tuple(settings.auto.bases) == AUTO_BASES
    if not default or tilt_spread(log) < LEAST_SPREAD:
        return settings
    bases = [*AUTO_BASES, *SLOPE_BASES]
    return settings.model_copy(update={"auto": settings.auto.model_copy(update={"bases": bases})})
