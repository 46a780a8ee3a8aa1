# SPDX-License-Identifier: Apache-2.0
"""What a log holds beside planar driving ahead, and the settings with which its slip is then tried."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipwise.calibration.settings import AUTO_BASES, Settings
from slipwise.errors import LogError
from slipwise.logs.log import Log

#: Bases with terms of gravity that `auto` averages too where roll and pitch were measured.
SLOPE_BASES = ("odd-even-13", "drive-9")
#: The same where the vehicle drives sideways.
SIDEWAYS_BASES = ("omni-8",)
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


def has_known_force(log: Log) -> bool:
    """Return whether a force on the robot was known: it pushes as gravity does on a slope.

    Raises:
        LogError: roll and pitch were measured too, of which gravity follows.
    """
    runs = [run for run in log.runs if run.poses.force_x is not None or run.poses.force_y is not None]
    if runs and has_attitude(log):
        raise LogError(
            "the log has both roll and pitch and a known force, and only one of them can explain a push",
            where=runs[0].name,
            advice="leave out the columns roll and pitch, and add gravity to force_x and force_y",
        )
    return bool(runs)


def for_the_ground_of(log: Log, settings: Settings) -> Settings:
    """Return the settings with which a log is learned.

    With terms of gravity where it has an attitude or a known force, of sideways speed where the vehicle is
    known to drive so.

    Only the default list of `auto` is extended; bases that were chosen stay as they are.
    """
    slopes = SLOPE_BASES if has_known_force(log) or has_attitude(log) else ()
    return _with(settings, (*slopes, *(SIDEWAYS_BASES if log.sideways else ())))


def with_gravity(settings: Settings) -> Settings:
    """Return the settings with terms of gravity in the default list of `auto`; other lists stay."""
    return _with(settings, SLOPE_BASES)


def _with(settings: Settings, more: Sequence[str]) -> Settings:
    if settings.basis != "auto" or tuple(settings.auto.bases) != AUTO_BASES or not more:
        return settings
    bases = [*AUTO_BASES, *more]
    return settings.model_copy(update={"auto": settings.auto.model_copy(update={"bases": bases})})
