# SPDX-License-Identifier: Apache-2.0
"""What an evaluation returns: every prediction beside its measurement, and scores per method and horizon."""

from __future__ import annotations

from dataclasses import dataclass

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import ErrorSummary
from slipwise.logs.log import LeftOut


@dataclass(frozen=True)
class Score:
    """One method at one horizon."""

    method: str
    causal: bool  # False: learned from the whole log, the windows judged included
    horizon: float  # s
    windows: int
    position: ErrorSummary  # m
    heading: ErrorSummary  # rad
    percent_of_distance: float  # mean position error / mean straight-line distance of the windows * 100
    position_ratio: tuple[float, float, float]  # mean error relative to `none`: value, low, high
    heading_ratio: tuple[float, float, float]
    position_to_rival: float  # mean error relative to the best other method than `none`
    heading_to_rival: float
    in_sample_position: float  # m, thesis-style residual: too optimistic, for comparison with Table 6.2
    in_sample_heading: float  # rad
    nis: float  # mean normalised innovation squared; 3 where the covariance is true
    nis_band: tuple[float, float]  # where its mean should lie with 95 %
    coverage: tuple[float, float, float]  # share of windows inside the 50, 90, 95 % ellipsoids
    stated_nis: float  # the same two where no growth and no tails are learned from earlier errors:
    stated_coverage: tuple[float, float, float]  # a filter's usual covariance, and normal ellipsoids


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
    models: tuple[str, ...] = ()  # those of the methods that are model files as they are

    def score(self, method: str, horizon: float) -> Score:
        """Return the score of `method` at `horizon`; KeyError where there is none."""
        for score in self.scores:
            if score.method == method and score.horizon == horizon:
                return score
        raise KeyError((method, horizon))


__all__ = ["ErrorSummary", "Evaluation", "Predictions", "Score"]
