# SPDX-License-Identifier: Apache-2.0
"""Whether a log holds an attitude, and the settings with which slip by gravity is then tried."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.settings import AUTO_BASES, Settings
from slipwise.logs.log import Log

#: Bases with terms of gravity that `auto` averages too where roll and pitch were measured.
SLOPE_BASES = ("odd-even-13", "drive-9")
_TINY = 1e-12  # rad; what is smaller everywhere was never measured


def has_attitude(log: Log) -> bool:
    """Return whether roll and pitch of some run were measured.

    How much they vary is not asked: a log that is cut off is learned with the same terms, so that no
    prediction depends on what comes after it.
    """
    return any(
        np.nanmax(np.abs(angle), initial=0.0) > _TINY
        for run in log.runs
        if run.poses.roll is not None and run.poses.pitch is not None
        for angle in (run.poses.roll, run.poses.pitch)
    )


def for_the_ground_of(log: Log, settings: Settings) -> Settings:
    """Return the settings with which a log is learned: with terms of gravity where it has an attitude.

    Only the default list of `auto` is extended; bases that were chosen stay as they are.
    """
    return with_gravity(settings) if has_attitude(log) else settings


def with_gravity(settings: Settings) -> Settings:
    """Return the settings with terms of gravity in the default list of `auto`; other lists stay."""
    if settings.basis != "auto" or tuple(settings.auto.bases) != AUTO_BASES:
        return settings
    bases = [*AUTO_BASES, *SLOPE_BASES]
    return settings.model_copy(update={"auto": settings.auto.model_copy(update={"bases": bases})})
