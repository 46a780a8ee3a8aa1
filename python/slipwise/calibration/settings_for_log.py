# SPDX-License-Identifier: Apache-2.0
"""What a log holds beside planar driving ahead, and the settings with which its slip is then tried."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.learning_tables import AUTO_BASES, SEGMENT_SECONDS, NoiseTable
from slipwise.calibration.settings import Settings
from slipwise.errors import LogError
from slipwise.logs.attitude import was_measured
from slipwise.logs.log import Log, has_course
from slipwise.segments import attitude_rows

#: Bases with terms of gravity that `auto` averages too where roll and pitch were measured.
SLOPE_BASES = ("odd-even-13", "drive-9")
#: The same where the vehicle drives sideways.
SIDEWAYS_BASES = ("omni-8",)
SIDEWAYS_SPEED, SIDEWAYS_PART = 0.05, 0.01  # m/s, and part of the inputs that are faster to a side
SEGMENT = 5.0  # s; positions tell only together how the robot turns. Those that tell it sooner end at half
# Of the default noise of slip. That of positions stands beside it, known by how far they scatter about the
# fitted way; where that of slip were much larger, it would hide what they tell of turns.
QUIET = 0.25
RESIDUALS = 2.0  # of a segment, independent: along, and across together with the turn


def has_attitude(log: Log) -> bool:
    """Return whether roll and pitch of some run were measured.

    How much they vary is not asked: a log that is cut off is learned with the same terms, so that no
    prediction depends on what comes after it.
    """
    return any(was_measured(attitude_rows(run)[:, 1:]) for run in log.runs)


def has_known_force(log: Log) -> bool:
    """Return whether a force on the robot was known: it pushes as gravity does on a slope.

    Raises:
        LogError: roll and pitch were measured too, of which gravity follows.
    """
    runs = [run for run in log.runs if run.forces is not None]
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
    known to drive so, or does.

    Only the default list of `auto` is extended; bases that were chosen stay as they are. Positions without
    headings are learned from in longer segments.
    """
    settings = for_positions(settings) if has_course(log.runs) else settings
    return for_ground(
        settings, slopes=has_known_force(log) or has_attitude(log), sideways=drives_sideways(log)
    )


def drives_sideways(log: Log) -> bool:
    """Return whether the vehicle is known to drive sideways, or its inputs say that it does."""
    inputs = (series for run in log.runs for series in (run.commands, run.wheels) if series is not None)
    return log.sideways or any(
        np.mean(np.abs(series.vy) > SIDEWAYS_SPEED) > SIDEWAYS_PART for series in inputs
    )


def takes_ground_for_level(settings: Settings) -> bool:
    """Whether the default list of `auto` is tried without its terms of gravity."""
    bases = set(settings.auto.bases) if settings.basis == "auto" else set()
    return set(AUTO_BASES) <= bases and not bases & set(SLOPE_BASES)


def for_ground(settings: Settings, *, slopes: bool, sideways: bool) -> Settings:
    """Return the settings with terms of gravity and of sideways speed in the default list of `auto`.

    Args:
        settings: whose other lists stay.
        slopes: roll and pitch, or a known force, are measured.
        sideways: the vehicle drives sideways too.
    """
    more = (*(SLOPE_BASES if slopes else ()), *(SIDEWAYS_BASES if sideways else ()))
    if settings.basis != "auto" or tuple(settings.auto.bases) != AUTO_BASES or not more:
        return settings
    bases = [*AUTO_BASES, *more]
    return settings.model_copy(update={"auto": settings.auto.model_copy(update={"bases": bases})})


def for_positions(settings: Settings) -> Settings:
    """Return settings with segments of 5 s, and a smaller noise of slip where it is the default.

    Given its own answer it changes nothing.
    """
    segment, noise, usual = settings.segment, settings.noise, NoiseTable()
    length = segment.length or max(SEGMENT_SECONDS.values())
    changed = {
        name: [factor * number for number in getattr(usual, name)]
        for name, factor in (("psd_motion", QUIET**2), ("fraction", QUIET))
        if getattr(noise, name) == getattr(usual, name)
    }
    return settings.model_copy(
        update={
            "segment": segment.model_copy(update={"length": max(length, SEGMENT)}),
            "noise": noise.model_copy(update=changed),
        }
    )
