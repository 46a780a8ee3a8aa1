# SPDX-License-Identifier: Apache-2.0
"""Choosing a few scored windows whose motions differ as much as possible."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.statistics import held_out_half
from slipwise.evaluation.result import Predictions
from slipwise.reporting.contents import Contents

MOST_WINDOWS = 9


@dataclass(frozen=True)
class ChosenWindow:
    """One window to be shown: its number on the page and its row in the learned method's predictions."""

    number: int
    row: int
    run: int
    t_start: float  # s
    t_end: float  # s


def choose_windows(contents: Contents) -> list[ChosenWindow]:
    """Choose among the scored windows of the longest horizon; numbered from 1, the most various first."""
    predictions = contents.predictions(contents.learned_method, contents.longest_horizon)
    if predictions is None:
        return []
    total = len(predictions.t_start)
    candidates = np.arange(total)[held_out_half(total)]
    candidates = candidates[np.isfinite(predictions.measured[candidates]).all(axis=1)]
    rows = candidates[_spread(_motions(predictions, candidates))].tolist()
    return [
        ChosenWindow(
            number,
            row,
            int(predictions.run[row]),
            float(predictions.t_start[row]),
            float(predictions.t_end[row]),
        )
        for number, row in enumerate(rows, start=1)
    ]


def _motions(predictions: Predictions, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return motion and, with less weight, place in the log of each window, scaled to spread, [N, 4]."""
    place = 0.5 * np.linspace(0.0, 1.0, len(rows))
    motion = predictions.measured[rows]
    spread = np.ptp(motion, axis=0) if len(rows) else np.ones(3)
    return np.column_stack((motion / np.where(spread > 0.0, spread, 1.0), place))


def _spread(points: NDArray[np.float64]) -> list[int]:
    """Take the point farthest from the middle, then again and again the one farthest from all taken."""
    if not len(points):
        return []
    distance = np.linalg.norm(points - points.mean(axis=0), axis=1)
    taken = [int(np.argmax(distance))]
    nearest = np.linalg.norm(points - points[taken[0]], axis=1)
    while len(taken) < min(MOST_WINDOWS, len(points)) and nearest.max() > 0.0:
        taken.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, np.linalg.norm(points - points[taken[-1]], axis=1))
    return taken
