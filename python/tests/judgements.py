# SPDX-License-Identifier: Apache-2.0
"""Held-out comparisons made by hand, for tests of what a verdict makes of them."""

from __future__ import annotations

from slipwise.calibration.consistency import Consistency
from slipwise.calibration.judgement import Judgement, Ratio, Still
from slipwise.models.schema import HeldOut

BETTER: Ratio = (0.5, 0.4, 0.6)


def ellipsoids(inside: float, nis: float = 3.1, *, segments: int = 30, factor: float = 1.0) -> Consistency:
    """The 95 % ellipsoids hold a part of the segments."""
    return Consistency(segments, (0.5, 0.8 * inside, inside), nis, 4.0 * nis, factor)


TRUE = ellipsoids(0.95)


def judged(
    position: Ratio,
    heading: Ratio,
    consistency: Consistency | None = None,
    *,
    windows: int = 9,
    still: float = 0.1,
) -> Judgement:
    """A judgement with these ratios to a baseline that errs by 1 m and 1 rad after 5 s."""
    errors = [0.0 if ratio[0] != ratio[0] else ratio[0] for ratio in (position, heading)]
    baseline = [0.0 if ratio[0] != ratio[0] else 1.0 for ratio in (position, heading)]
    held_out = HeldOut(
        horizon=5.0,
        segments=windows,
        position=errors[0],
        heading=errors[1],
        baseline_position=baseline[0],
        baseline_heading=baseline[1],
    )
    return Judgement(held_out, position, heading, Still(2.0, still, 1.0), consistency)
