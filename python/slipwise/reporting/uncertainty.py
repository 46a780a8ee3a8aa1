# SPDX-License-Identifier: Apache-2.0
"""Whether the reported uncertainty is true, in a sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.evaluation.result import Score
from slipwise.reporting.markup import number

TRUE = "Yes"
_HELD = 0.95  # by the ellipsoid that is judged
_RARE = 0.025  # probability of a count that a true covariance has no more often, to either side


@dataclass(frozen=True)
class Honesty:
    """What held-out predictions say of their covariance."""

    answer: str  # to the question whether it is true
    short: str  # the reason in a few words
    figures: str  # the figures behind it, a sentence

    @property
    def sentence(self) -> str:
        """All three, the reason once."""
        reason = "" if self.answer == TRUE else f" {self.short[0].upper()}{self.short[1:]}."
        return f"{self.answer}.{reason} {self.figures}"


def honesty_of(score: Score | None) -> Honesty | None:
    """Judge the covariance by how many measured ends its 95 % ellipsoids hold, and by the mean NIS.

    Returns:
        None where there is no covariance to judge.
    """
    if score is None or not score.windows or not math.isfinite(score.nis) or math.isnan(score.coverage[2]):
        return None
    inside = round(score.coverage[2] * score.windows)
    low, high = score.nis_band
    held = f"{inside} of {score.windows} measured ends ({100.0 * score.coverage[2]:.0f} %)"
    size = f"errors are {number(math.sqrt(score.nis / 3.0), 2)} times as large as it says"
    figures = (
        f"{held} lie inside the 95 % ellipsoids of the predictions over {score.horizon:g} s; the mean NIS is "
        f"{number(score.nis)}, and {number(low)} to {number(high)} is expected of a true covariance."
    )
    if _at_most(inside, score.windows) < _RARE:
        return Honesty("No, it is too small", size, figures)
    if score.nis > high:
        return Honesty("Nearly, it is a little small", size, figures)
    if score.nis < low:
        return Honesty("Yes, with a margin", size, figures)
    return Honesty(TRUE, f"{held} lie inside their 95 % ellipsoids", figures)


def _at_most(inside: int, count: int) -> float:
    """Return how likely no more than `inside` of `count` ends are held by true ellipsoids (binomial)."""
    return math.fsum(
        math.exp(
            math.lgamma(count + 1)
            - math.lgamma(k + 1)
            - math.lgamma(count - k + 1)
            + k * math.log(_HELD)
            + (count - k) * math.log1p(-_HELD)
        )
        for k in range(inside + 1)
    )
