# SPDX-License-Identifier: Apache-2.0
"""Whether the reported uncertainty is true: held-out errors beside the ellipsoids that should hold them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import coverage, held_out_half, nis_band, share_interval
from slipwise.number_text import number_text
from slipwise.student import fraction_inside

STATED = 0.95  # of the segments lie within these ellipsoids, where the covariance is true
LEAST_INSIDE = 0.9  # a covariance is too small where surely fewer lie within their 95 % ellipsoids
MOST_INSIDE = 0.75  # and too large where surely more lie within their 50 % ellipsoids
ENOUGH = 20  # segments from which on a covariance too large is said; before, the prior's caution shows
UNTRUE = 0.5  # part of the windows; a 95 % ellipsoid that holds fewer is no statement of uncertainty
USUAL_NIS = 3.0  # mean of a chi-square of 3 degrees of freedom
FAR = 3.0  # times the end of the band of the mean NIS: beyond it heavy tails are said

Shares = tuple[float, float, float]


@dataclass(frozen=True)
class Consistency:
    """Coverage of the held-out segments by their ellipsoids, and how far those outside lie."""

    segments: int
    inside: Shares  # parts of the segments within their 50, 90 and 95 % ellipsoids
    nis: float  # mean normalised innovation squared; 3 where errors are normal and the covariance is true
    farthest: float  # the largest of them
    factor: float | None  # of the covariances, so that 95 % ellipsoids hold 95 %; None where they are true

    @property
    def too_small(self) -> bool:
        """Whether the ellipsoids hold far fewer segments than they should, beyond chance."""
        return share_interval(self.inside[2], self.segments)[1] < LEAST_INSIDE

    @property
    def too_large(self) -> bool:
        """Whether the ellipsoids hold far more segments than they should, beyond chance."""
        return self.segments >= ENOUGH and share_interval(self.inside[0], self.segments)[0] > MOST_INSIDE

    @property
    def heavy_tails(self) -> bool:
        """Whether the ellipsoids hold what they should, and those few errors outside are very large."""
        return not self.too_small and self.nis > FAR * nis_band(self.segments)[1]

    @property
    def untrue(self) -> bool:
        """Whether the ellipsoids are so small that no plan may rest on them."""
        return self.too_small and self.inside[2] < UNTRUE

    @property
    def true(self) -> bool:
        """Whether nothing speaks against the reported covariance."""
        return not (self.too_small or self.too_large)

    def sentence(self) -> str:
        """Say what is wrong with the ellipsoids, or that few errors lie far outside; else empty."""
        if self.too_small:
            return (
                f"Its reported uncertainty is too small: the 95 % ellipsoids hold {self._of(2)} "
                f"held-out segments (mean NIS {number_text(self.nis)}, {USUAL_NIS:g} is true)."
            )
        if self.too_large:
            return (
                f"Its reported uncertainty is too large: the 50 % ellipsoids hold {self._of(0)} "
                f"held-out segments (mean NIS {number_text(self.nis)}, {USUAL_NIS:g} is true)."
            )
        if self.heavy_tails:
            return (
                f"Its errors have heavy tails: the 95 % ellipsoids hold {self._of(2)} held-out segments, "
                f"but the farthest has a NIS of {number_text(self.farthest)}, and the mean is "
                f"{number_text(self.nis)} ({USUAL_NIS:g} is usual)."
            )
        return ""

    def advice(self) -> tuple[str, ...]:
        """Say what to do about ellipsoids that are not true, and where to look for what made the tails."""
        look = "The report's errors over time show where it fails: pose jumps, or terrain that changed?"
        if self.true or self.factor is None:
            return (look,) if self.heavy_tails else ()
        factor = number_text(self.factor, 2)
        scale = f"Multiply predicted covariances by {factor} before you plan with them."
        return (f"{scale} {look}" if self.too_small else scale,)

    def _of(self, ellipsoid: int) -> str:
        share = self.inside[ellipsoid]
        return f"{round(share * self.segments)} of {self.segments} ({100.0 * share:.0f} %)"


def consistency_of(learned: Predictions) -> Consistency | None:
    """Compare errors with ellipsoids on the second half of the segments; None where there is none."""
    half = held_out_half(len(learned))
    nis = learned.nis[half]
    if len(nis) == 0:
        return None
    found = Consistency(
        segments=len(nis),
        inside=coverage(learned.inside[half]),
        nis=float(np.mean(nis)),
        farthest=float(np.max(nis)),
        factor=None,
    )
    return found if found.true else replace(found, factor=_mending_factor(nis, learned.dof[half]))


def _mending_factor(nis: NDArray[np.float64], dof: NDArray[np.float64]) -> float:
    """The least factor of the covariances with which the 95 % ellipsoids hold 95 % of the segments."""
    low, high = np.log(1e-9), np.log(1e9)
    for _ in range(50):
        middle = 0.5 * (low + high)
        held = np.mean(fraction_inside(nis / np.exp(middle), dof) <= STATED)
        low, high = (low, middle) if held >= STATED else (middle, high)
    return float(np.exp(high))
