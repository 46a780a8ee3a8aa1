# SPDX-License-Identifier: Apache-2.0
"""Scores of predictions over the second half of the windows: errors, ratios to the baseline, coverage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.statistics import (
    coverage,
    held_out_half,
    nis_band,
    normal_coverage,
    ratio_of_means,
    summarise,
)
from slipwise.evaluation.result import Score


def scores_of(
    predictions: Sequence[Predictions], baseline: Mapping[float, Predictions], sets: Sequence[WindowSet]
) -> tuple[Score, ...]:
    """Return the score of each method at each horizon, relative to the baseline's predictions there."""
    scores = []
    for targets in sets:
        group = [p for p in predictions if p.horizon == targets.length]
        distance = float(targets.distances()[held_out_half(len(targets))].mean())
        scores += [_score(p, baseline[targets.length], group, distance) for p in group]
    return tuple(scores)


def _score(
    predictions: Predictions, baseline: Predictions, group: Sequence[Predictions], distance: float
) -> Score:
    half = held_out_half(len(predictions))
    position, heading = predictions.position_error[half], predictions.heading_error[half]
    nis = predictions.nis[half]
    return Score(
        method=predictions.method,
        causal=predictions.causal,
        horizon=predictions.horizon,
        windows=len(position),
        position=summarise(position),
        heading=summarise(heading),
        percent_of_distance=float(100.0 * position.mean() / distance) if distance > 0.0 else float("nan"),
        position_ratio=ratio_of_means(position, baseline.position_error[half]),
        heading_ratio=ratio_of_means(heading, baseline.heading_error[half]),
        position_to_rival=_to_rival(predictions, group, "position_error"),
        heading_to_rival=_to_rival(predictions, group, "heading_error"),
        in_sample_position=float(predictions.in_sample[half, 0].mean()),
        in_sample_heading=float(predictions.in_sample[half, 1].mean()),
        nis=float(nis.mean()),
        nis_band=nis_band(len(nis)),
        coverage=coverage(predictions.inside[half]),
        reported_nis=float(predictions.reported_nis[half].mean()),
        reported_coverage=normal_coverage(predictions.reported_nis[half]),
    )


def _to_rival(predictions: Predictions, group: Sequence[Predictions], error: str) -> float:
    """Mean error relative to the best other causal method but the plain one."""
    half = held_out_half(len(predictions))
    others = [
        float(getattr(p, error)[half].mean())
        for p in group
        if p.method not in (predictions.method, "none") and p.causal
    ]
    best = min(others, default=0.0)
    return float(getattr(predictions, error)[half].mean()) / best if best > 0.0 else float("nan")
