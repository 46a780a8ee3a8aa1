# SPDX-License-Identifier: Apache-2.0
"""Predictions beside what was measured, and how wrong they were."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.student import fraction_inside

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Predictions:
    """The predictions of one method at one horizon, [N] each; poses are T_start_end."""

    method: str
    horizon: float  # s, as asked for
    run: Ints  # index of the run in the log
    t_start: Floats  # s
    t_end: Floats  # s
    pose: Floats  # [N, 3] predicted x, y [m], yaw [rad]
    covariance: Floats  # [N, 3, 3] of a Student t, inflation included
    inflation: Floats  # [N] factor in the covariance that follows from earlier held-out windows
    dof: Floats  # [N] degrees of freedom of the t, from the same windows; few are heavy tails
    nominal_nis: Floats  # [N] as `reported_nis`, had nothing recent been known of the slip disturbance
    structure: Ints  # [N] of STRUCTURES, that predicted
    measured: Floats  # [N, 3] what the poses say
    learned_until: Floats  # s, in the log's time: nothing measured later was used
    in_sample: Floats  # [N, 2] position [m], heading [rad] error after learning the window (Table 6.2)

    def __len__(self) -> int:
        return len(self.t_start)

    def __repr__(self) -> str:
        return f"<Predictions: {len(self)} over {self.horizon:g} s by {self.method}>"

    @property
    def causal(self) -> bool:
        """Whether nothing measured after the start of a prediction was used."""
        return bool((self.learned_until <= self.t_start).all())

    @property
    def residual(self) -> Floats:
        """Measured minus predicted chart, the heading wrapped to half a turn, [N, 3]."""
        return residual(self.measured, self.pose)

    @property
    def position_error(self) -> Floats:
        """Distance between predicted and measured position, [N] m."""
        return np.hypot(self.residual[:, 0], self.residual[:, 1])

    @property
    def heading_error(self) -> Floats:
        """Absolute heading error, wrapped to half a turn, [N] rad."""
        return np.abs(self.residual[:, 2])

    @property
    def distance(self) -> Floats:
        """How far the robot went in a straight line, [N] m: the position error of one said to stand still."""
        return np.hypot(self.measured[:, 0], self.measured[:, 1])

    @property
    def turn(self) -> Floats:
        """How far it turned, to half a turn, [N] rad: the heading error of one said to stand still."""
        return np.abs(residual(self.measured, np.zeros_like(self.measured))[:, 2])

    @property
    def nis(self) -> Floats:
        """Normalised innovation squared, [N]; 3 on average where the covariance is true."""
        return normalised_squared(self.residual, self.covariance)

    @property
    def reported_nis(self) -> Floats:
        """The same under the covariance without inflation: of a filter that never looks back, [N]."""
        return self.nis * self.inflation

    @property
    def inside(self) -> Floats:
        """Fraction of the smallest ellipsoid of the predicted t that holds the measured pose, [N], 0 to 1."""
        return fraction_inside(self.nis, self.dof)


def residual(measured: Floats, predicted: Floats) -> Floats:
    """Measured minus predicted charts, [N, 3], the heading wrapped to half a turn."""
    difference = measured - predicted
    difference[:, 2] = np.remainder(difference[:, 2] + np.pi, 2.0 * np.pi) - np.pi
    return difference


def normalised_squared(residuals: Floats, covariance: Floats) -> Floats:
    """Squared Mahalanobis lengths of [N, 3] residuals under [N, 3, 3] covariances."""
    if len(residuals) == 0:
        return np.empty(0)
    solved = np.linalg.solve(covariance, residuals[:, :, None])[:, :, 0]
    return np.asarray(np.einsum("ni,ni->n", residuals, solved), dtype=np.float64)
