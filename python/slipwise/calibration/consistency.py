# SPDX-License-Identifier: Apache-2.0
"""Whether the reported uncertainty is true: held-out errors beside the ellipsoids that should hold them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import coverage, held_out_half, nis_band
from slipwise.number_text import number_text

TRUE_NIS = 3.0  # mean of a chi-square of 3 degrees of freedom
FAR = 3.0  # times the end of the band: beyond it the mean NIS is said; heavy tails leave the band itself
ENOUGH = 20  # segments from which on a NIS that is too small is said; before, the prior's caution shows
UNTRUE = 0.5  # part of the windows; a 95 % ellipsoid that holds fewer is no statement of uncertainty


@dataclass(frozen=True)
class Consistency:
    """Normalised innovation squared and coverage on the held-out segments."""

    nis: float  # mean; 3 where the covariance is true
    segments: int
    band: tuple[float, float]  # where the mean lies with 95 %, were all errors normal
    inside: float  # part of the segments within their 95 % ellipsoids

    @property
    def too_small(self) -> bool:
        """Whether the reported covariance is far too small."""
        return self.nis > FAR * self.band[1]

    @property
    def too_large(self) -> bool:
        """Whether the reported covariance is far too large."""
        return self.segments >= ENOUGH and self.nis < self.band[0] / FAR

    @property
    def untrue(self) -> bool:
        """Whether the ellipsoids are so small that no plan may rest on them."""
        return self.too_small and self.inside < UNTRUE

    @property
    def true(self) -> bool:
        """Whether nothing speaks against the reported covariance."""
        return not (self.too_small or self.too_large)

    def sentence(self) -> str:
        """Say what is wrong with the ellipsoids; empty where they are true."""
        if self.true:
            return ""
        size = "small" if self.too_small else "large"
        return (
            f"Its reported uncertainty is too {size}: NIS {number_text(self.nis)} ({TRUE_NIS:g} is true), "
            f"and the 95 % ellipsoids hold {100.0 * self.inside:.0f} % of the held-out segments."
        )

    def advice(self) -> tuple[str, ...]:
        """Say what to do about ellipsoids that are not true."""
        if self.true:
            return ()
        factor = number_text(self.nis / TRUE_NIS, 2)
        look = (
            " The report's errors over time show where it fails: pose jumps, or terrain that changed?"
            if self.too_small
            else ""
        )
        return (f"Multiply predicted covariances by {factor} before you plan with them.{look}",)


def consistency_of(learned: Predictions) -> Consistency | None:
    """Compare errors with ellipsoids on the second half of the segments; None where there is none."""
    half = held_out_half(len(learned))
    nis = learned.nis[half]
    if len(nis) == 0:
        return None
    return Consistency(float(np.mean(nis)), len(nis), nis_band(len(nis)), coverage(learned.inside[half])[2])
