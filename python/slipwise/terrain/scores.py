# SPDX-License-Identifier: Apache-2.0
"""Scores of probabilities against known surfaces: accuracy, calibration error, log score."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

BINS = 10  # of equal width, over the probability of the most probable surface


@dataclass(frozen=True)
class Score:
    """How good probabilities are."""

    windows: int
    accuracy: float  # of the most probable surface
    calibration_error: float  # expected calibration error of its probability
    log_loss: float  # mean negative log probability of the true surface
    recall: dict[str, float]  # by surface, NaN where there is none


def score_of(probability: Floats, labels: NDArray[np.object_], surfaces: Sequence[str]) -> Score:
    """Score probabilities [N, K] against labels [N], each among `surfaces`."""
    truth = np.array([list(surfaces).index(name) for name in labels], dtype=np.int64)
    best = probability.argmax(axis=1)
    right = best == truth
    own = probability[np.arange(len(truth)), truth]
    recall = {
        name: float(right[truth == k].mean()) if (truth == k).any() else float("nan")
        for k, name in enumerate(surfaces)
    }
    return Score(
        windows=len(truth),
        accuracy=float(right.mean()),
        calibration_error=expected_calibration_error(probability.max(axis=1), right),
        log_loss=float(-np.log(np.maximum(own, 1e-6)).mean()),
        recall=recall,
    )


def expected_calibration_error(confidence: Floats, right: NDArray[np.bool_]) -> float:
    """Return the mean distance of confidence [N] from the share that is right, over bins of confidence."""
    index = np.minimum((confidence * BINS).astype(np.int64), BINS - 1)
    gaps = [abs(float((confidence[index == k] - right[index == k]).sum())) for k in range(BINS)]
    return sum(gaps) / len(confidence)
