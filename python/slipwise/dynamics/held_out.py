# SPDX-License-Identifier: Apache-2.0
"""Predictions of a user's dynamics beside what was measured afterwards, and how true their covariance is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.dynamics.dynamics import Dynamics
from slipwise.dynamics.learned_dynamics import DynamicsScore
from slipwise.dynamics.recorded import Recorded

Floats = NDArray[np.float64]

PRIOR_WINDOWS = 5.0  # as many windows the stated covariance counts for before errors are seen


@dataclass(frozen=True)
class HeldOut:
    """From measurement `start` to measurement `end`, as learned and as given parameters foresaw it."""

    start: int
    end: int
    learned: _core.DynamicsPrediction
    given: _core.DynamicsPrediction


def judged(
    dynamics: Dynamics, drive: Recorded, made: Mapping[float, Sequence[HeldOut]]
) -> tuple[DynamicsScore, ...]:
    """Score the second half of the predictions of each horizon; horizons without two are left out."""
    return tuple(_score(dynamics, drive, h, rows) for h, rows in made.items() if len(rows) >= 2)


def _score(dynamics: Dynamics, drive: Recorded, horizon: float, rows: Sequence[HeldOut]) -> DynamicsScore:
    learned = np.array([_error(dynamics, drive, row.end, row.learned) for row in rows])
    given = np.array([_error(dynamics, drive, row.end, row.given) for row in rows])
    squared = np.array(
        [_squared(dynamics, error, row.learned) for error, row in zip(learned, rows, strict=True)]
    )
    size = learned.shape[1]
    # Each prediction is inflated by the errors of those that ended before it began.
    ends, starts = drive.t[[row.end for row in rows]], drive.t[[row.start for row in rows]]
    before = np.searchsorted(ends, starts, side="right")
    sums = np.concatenate(([0.0], np.cumsum(squared / size)))
    inflation = (PRIOR_WINDOWS + sums[before]) / (PRIOR_WINDOWS + before)
    half = slice(len(rows) // 2, None)
    return DynamicsScore(
        horizon=horizon,
        windows=len(rows) - len(rows) // 2,
        names=dynamics.measured_names,
        error=tuple(np.sqrt((learned[half] ** 2).mean(axis=0)).tolist()),
        given_error=tuple(np.sqrt((given[half] ** 2).mean(axis=0)).tolist()),
        nis=float((squared / inflation)[half].mean() / size),
        inflation=float((PRIOR_WINDOWS + sums[-1]) / (PRIOR_WINDOWS + len(rows))),
    )


def _error(dynamics: Dynamics, drive: Recorded, end: int, predicted: _core.DynamicsPrediction) -> Floats:
    """Measured minus predicted, [measured states]; angles without whole turns."""
    difference = drive.measured[end] - predicted.state[list(dynamics.measured)]
    angle = np.array([dynamics.states[place].angle for place in dynamics.measured])
    turned = np.arctan2(np.sin(difference), np.cos(difference))
    return np.asarray(np.where(angle, turned, difference), dtype=np.float64)


def _squared(dynamics: Dynamics, error: Floats, predicted: _core.DynamicsPrediction) -> float:
    """The squared error in its covariance, the measurement's noise included."""
    places = list(dynamics.measured)
    noise = np.diag([(dynamics.states[place].measured or 0.0) ** 2 for place in places])
    covariance = predicted.covariance[np.ix_(places, places)] + noise
    return float(error @ np.linalg.solve(covariance, error))
