# SPDX-License-Identifier: Apache-2.0
"""What every slip surface can do: learn from examples, and predict slip rates with standard deviations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.errors import SettingsError
from slipwise_thesis.surfaces.examples import SlipExamples

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SurfacePrediction:
    """Slip rates that new segments may show, (m/s, m/s, rad/s) per row."""

    mean: Floats  # [M, 3]
    std: Floats  # [M, 3] of a new segment's slip rate: noise and what is not known of the surface
    freedom: Floats  # [3] degrees of freedom of its Student-t distribution; infinite: Gaussian


class SlipSurface(Protocol):
    """Slip rates over speed and yaw rate (thesis chapter 5)."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user must know about the last fit, in sentences: directions without data, subsets used."""
        ...

    def fit(self, examples: SlipExamples) -> None:
        """Learn from these examples alone."""
        ...

    def predict(self, v: ArrayLike, omega: ArrayLike) -> SurfacePrediction:
        """Predict at speeds [M] m/s and yaw rates [M] rad/s."""
        ...


class UpdatableSurface(SlipSurface, Protocol):
    """A surface that also learns on-line."""

    def update(self, example: SlipExamples) -> None:
        """Learn from more examples, one or several, without forgetting the earlier ones."""
        ...


def drive_arrays(v: ArrayLike, omega: ArrayLike) -> tuple[Floats, Floats]:
    """Return speeds and yaw rates as arrays of one length [M].

    Raises:
        SettingsError: lengths differ, or a number is not finite.
    """
    speeds, yaw_rates = np.broadcast_arrays(
        np.atleast_1d(np.asarray(v, dtype=np.float64)), np.atleast_1d(np.asarray(omega, dtype=np.float64))
    )
    if speeds.ndim != 1 or not (np.isfinite(speeds).all() and np.isfinite(yaw_rates).all()):
        raise SettingsError("speeds and yaw rates to predict at must be finite and of one dimension")
    return np.ascontiguousarray(speeds), np.ascontiguousarray(yaw_rates)


def not_fitted() -> SettingsError:
    """Return the error of a surface that is asked before it has learned."""
    return SettingsError("the surface has learned nothing yet", advice="call fit with examples first")
