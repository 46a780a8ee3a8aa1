# SPDX-License-Identifier: Apache-2.0
"""The settings with which positions without headings are learned from."""

from __future__ import annotations

from slipwise.calibration.learning_tables import SEGMENT_SECONDS, NoiseTable
from slipwise.calibration.settings import Settings

SEGMENT = 5.0  # s; positions tell only together how the robot turns. Those that tell it sooner end at half
# Of the default noise of slip. That of positions stands beside it, known by how far they scatter about the
# fitted way; where that of slip were much larger, it would hide what they tell of turns.
QUIET = 0.25
RESIDUALS = 2.0  # of a segment, independent: along, and across together with the turn


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
