# SPDX-License-Identifier: Apache-2.0
"""What an evaluation returns: every prediction beside its measurement, and scores per method and horizon."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import LeftOut

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Predictions:
    """The predictions of one method at one horizon, [N] each; poses are T_start_end, in the robot's frame at the start."""

    method: str
    horizon: float  # s, as asked for
    run: NDArray[np.int64]  # index of the run in the log
    t_start: Floats  # s
    t_end: Floats  # s
    pose: Floats  # [N, 3] predicted x, y [m], yaw [rad]
    covariance: Floats  # [N, 3, 3]
    measured: Floats  # [N, 3] what the poses say
    learned_until: Floats  # s, in the log's time: nothing measured later was used
    in_sample: Floats  # [N, 2] position [m] and heading [rad] error after learning the same window (thesis, Table 6.2)

    @property
    def position_error(self) -> Floats:
        """Distance between predicted and measured position, [N] m."""
        return np.hypot(*(self.pose[:, :2] - self.measured[:, :2]).T)

    @property
    def heading_error(self) -> Floats:
        """Absolute heading error wrapped to half a turn, [N] rad."""
        difference = self.pose[:, 2] - self.measured[:, 2]
        return np.abs(np.remainder(difference + np.pi, 2 * np.pi) - np.pi)


@dataclass(frozen=True)
class ErrorSummary:
    """One kind of error over the windows, with a 95 % block-bootstrap interval of its mean."""

    mean: float
    low: float
    high: float
    median: float
    rmse: float
    p95: float


@dataclass(frozen=True)
class Score:
    """One method at one horizon."""

    method: str
    causal: bool  # False: learned from the whole log, the windows judged included
    horizon: float  # s
    windows: int
    position: ErrorSummary  # m
    heading: ErrorSummary  # rad
    percent_of_distance: float  # mean position error / mean distance driven * 100
    position_ratio: tuple[float, float, float]  # mean error relative to `none`: value, low, high
    heading_ratio: tuple[float, float, float]
    position_to_rival: float  # mean error relative to the best other method than `none`
    heading_to_rival: float
    in_sample_position: float  # m, thesis-style residual: too optimistic, for comparison with Table 6.2
    in_sample_heading: float  # rad
    nis: float  # mean normalised innovation squared; 3 where the covariance is true
    nis_band: tuple[float, float]  # where its mean should lie with 95 %
    coverage: tuple[float, float, float]  # share of windows inside the 50, 90, 95 % ellipsoids


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The result of `slipwise.evaluate`."""

    input: str  # "command" or "wheel"
    horizons: tuple[float, ...]  # s
    methods: tuple[str, ...]
    scores: tuple[Score, ...]  # over the second half of the windows
    predictions: tuple[Predictions, ...]  # of all windows
    runs: tuple[str, ...]  # run names
    left_out: tuple[LeftOut, ...]
    notes: tuple[str, ...]

    def score(self, method: str, horizon: float) -> Score:
        """Return the score of `method` at `horizon`; KeyError where there is none."""
        for score in self.scores:
            if score.method == method and score.horizon == horizon:
                return score
        raise KeyError((method, horizon))
