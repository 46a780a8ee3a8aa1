# SPDX-License-Identifier: Apache-2.0
"""A simpler method of the same table, or one that learns from this log, that predicts clearly better."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise import _core
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Calibration
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.evaluation.result import Evaluation

_BETTER = 0.9  # of the errors of the method judged, geometric mean of position and heading
Ratio = tuple[float, float, float]


@dataclass(frozen=True)
class Simpler:
    """A basis with fewer terms that is clearly better."""

    method: str
    horizon: float  # s
    position: float  # m
    heading: float  # rad
    position_ratio: Ratio  # of its errors to those of the method judged, with the 95 % interval
    heading_ratio: Ratio
    of_file: bool = False  # the method judged is a model file, which learned from another log

    def advice(self) -> str:
        """Propose it."""
        errors = (
            f"predicts clearly better: {self.position:.3g} m and {self.heading:.3g} rad after "
            f"{self.horizon:g} s, {self.position_ratio[0]:.2f} and {self.heading_ratio[0]:.2f} times these "
            "errors."
        )
        if self.of_file:
            return (
                f"What this log itself teaches ({self.method}) {errors} The robot, its load or its ground "
                "may have changed: calibrate from this log, and compare the two models."
            )
        return f"{self.method}, of {_terms(self.method):.0f} slip terms, {errors} Use --basis {self.method}."


def simpler_method(evaluation: Evaluation, judged: str) -> Simpler | None:
    """Return the best of the simpler bases that are clearly better than `judged` at the longest horizon.

    A model file, which learned from another log, is judged by the average that learns from this one: of ten
    bases one is better by chance. Without an average any basis that does may be. Clearly better is a basis
    that is worse in neither position nor heading, better in one beyond chance, and by a tenth on the whole:
    the best of many is a little better by chance alone.
    """
    longest = [p for p in evaluation.predictions if p.horizon == max(evaluation.horizons)]
    own = next((p for p in longest if p.method == judged), None)
    if own is None:
        return None
    of_file = judged in evaluation.models and own.causal
    causal = [p for p in longest if p.causal]
    average = [p for p in causal if p.method == "auto"] if of_file else []
    tried = average or [p for p in causal if _terms(p.method) < _terms(judged)]
    others = [replace(_beside(p, own), of_file=of_file) for p in tried]
    better = [other for other in others if _clearly_better(other)]
    return min(better, key=lambda other: other.position_ratio[0] * other.heading_ratio[0], default=None)


def proposing(calibration: Calibration, evaluation: Evaluation) -> Calibration:
    """Add to the advice of a good or bad verdict a simpler basis of an evaluation on the same log."""
    verdict = calibration.verdict
    found = None if verdict.contradictions else simpler_method(evaluation, calibration.method)
    if found is None:
        return calibration
    return replace(calibration, verdict=replace(verdict, advice=(*verdict.advice, found.advice())))


def _terms(method: str) -> float:
    """Number of slip terms of a basis; what averages bases, or is none, counts as having more than any."""
    if method not in _core.basis_names():
        return float("inf")
    basis = _core.named_basis(method)
    return float(len(basis.lon) + len(basis.lat) + len(basis.ang))


def _beside(other: Predictions, own: Predictions) -> Simpler:
    half = held_out_half(len(own))
    return Simpler(
        method=other.method,
        horizon=other.horizon,
        position=float(other.position_error[half].mean()),
        heading=float(other.heading_error[half].mean()),
        position_ratio=ratio_of_means(other.position_error[half], own.position_error[half]),
        heading_ratio=ratio_of_means(other.heading_error[half], own.heading_error[half]),
    )


def _clearly_better(other: Simpler) -> bool:
    ratios = (other.position_ratio, other.heading_ratio)
    on_the_whole = float(np.sqrt(ratios[0][0] * ratios[1][0]))
    never_worse = all(ratio[0] <= 1.0 for ratio in ratios)
    return never_worse and any(ratio[2] < 1.0 for ratio in ratios) and on_the_whole < _BETTER
