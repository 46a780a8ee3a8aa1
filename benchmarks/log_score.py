# SPDX-License-Identifier: Apache-2.0
"""What an evaluation said of one log with one input, and geometric means over logs, relative to `none`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from uncertainty import chance_of_range, normal_score

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import held_out_half
from slipwise.evaluation import Evaluation, Score

FEWEST_WINDOWS = 3  # held-out windows; logs with fewer are listed, not averaged


@dataclass(frozen=True)
class MethodScore:
    """One method on one log."""

    causal: bool
    position: float  # m, mean error
    heading: float  # rad, mean error
    position_ratio: tuple[float, float, float]  # to `none`: value, 95 % interval
    heading_ratio: tuple[float, float, float]
    nis: float  # 3 where the covariance is true
    nis_band: tuple[float, float]
    coverage: tuple[float, float, float]  # of the 50, 90, 95 % ellipsoids
    normal_nis: float  # the NIS once errors are stretched to normal ones by the predicted t
    nis_chance: float  # that the mean NIS lies in the range asked for, where the predicted t are true
    reported_nis: float  # with the usual covariance, that learns nothing from held-out errors
    reported_coverage: tuple[float, float, float]
    windows: int  # held out


@dataclass(frozen=True)
class LogScore:
    """All methods on one log with one input."""

    log: str
    input: str
    horizon: float  # s
    windows: int  # held out: the second half
    all_windows: int
    seconds: float  # wall time of the evaluation
    methods: dict[str, MethodScore]

    @property
    def counts(self) -> bool:
        """Whether the log has enough held-out windows for the means."""
        return self.windows >= FEWEST_WINDOWS

    def best_basis(self, error: str) -> str:
        """Return the fixed basis with the least mean error ("position" or "heading"), chosen afterwards."""
        special = ("none", "vendor", "batch", "auto")
        return min((m for m in self.methods if m not in special), key=lambda m: self._error(m, error))

    def _error(self, method: str, error: str) -> float:
        score = self.methods[method]
        return score.position if error == "position" else score.heading


@dataclass(frozen=True)
class MeanScore:
    """One method over all logs that count, relative to `none`."""

    logs: int
    position: float
    heading: float
    worst_position: float
    worst_position_log: str
    worst_heading: float
    worst_heading_log: str


def log_score(name: str, evaluation: Evaluation, seconds: float) -> LogScore:
    """Take from an evaluation over one horizon what the benchmark keeps."""
    by_name = {p.method: p for p in evaluation.predictions}
    methods = {score.method: _method_score(score, by_name[score.method]) for score in evaluation.scores}
    held_out, total = methods["none"].windows, len(evaluation.predictions[0])
    return LogScore(name, evaluation.input, evaluation.horizons[0], held_out, total, seconds, methods)


def mean_score(scores: Sequence[LogScore], method: str) -> MeanScore | None:
    """Average a method over the logs that count and have it; None where there are none."""
    having = [score for score in scores if score.counts and method in score.methods]
    if not having:
        return None
    position = {s.log: s.methods[method].position_ratio[0] for s in having}
    heading = {s.log: s.methods[method].heading_ratio[0] for s in having}
    worst_position = max(position, key=position.__getitem__)
    worst_heading = max(heading, key=heading.__getitem__)
    return MeanScore(
        logs=len(having),
        position=geometric_mean(list(position.values())),
        heading=geometric_mean(list(heading.values())),
        worst_position=position[worst_position],
        worst_position_log=worst_position,
        worst_heading=heading[worst_heading],
        worst_heading_log=worst_heading,
    )


def best_basis_mean(scores: Sequence[LogScore]) -> tuple[float, float]:
    """Return what choosing the best fixed basis of each log afterwards would give: position, heading."""
    counted = [score for score in scores if score.counts]
    return (
        geometric_mean([s.methods[s.best_basis("position")].position_ratio[0] for s in counted]),
        geometric_mean([s.methods[s.best_basis("heading")].heading_ratio[0] for s in counted]),
    )


def geometric_mean(ratios: Sequence[float]) -> float:
    """Return the geometric mean of positive ratios; those that are not defined do not count."""
    defined = [ratio for ratio in ratios if math.isfinite(ratio) and ratio > 0.0]
    return math.exp(sum(map(math.log, defined)) / len(defined)) if defined else math.nan


def _method_score(score: Score, predictions: Predictions) -> MethodScore:
    half = held_out_half(len(predictions))
    return MethodScore(
        causal=score.causal,
        position=score.position.mean,
        heading=score.heading.mean,
        position_ratio=score.position_ratio,
        heading_ratio=score.heading_ratio,
        nis=score.nis,
        nis_band=score.nis_band,
        coverage=score.coverage,
        normal_nis=normal_score(predictions.inside[half]),
        nis_chance=chance_of_range(predictions, half),
        reported_nis=score.reported_nis,
        reported_coverage=score.reported_coverage,
        windows=score.windows,
    )
