# SPDX-License-Identifier: Apache-2.0
"""Keeps what was believed after each window, for each structure that learned it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import STRUCTURES, Belief, Progress
from slipwise.calibration.result import History
from slipwise.calibration.stamp_spacing import StampSpacing

Floats = NDArray[np.float64]


class HistoryRecorder:
    """Writes one row per window and structure."""

    def __init__(self, windows: WindowSet, bases: tuple[str, ...], progress: Progress | None = None) -> None:
        """`windows` are those learned; `progress` is called with the share of them that is."""
        self._windows, self._bases, self._progress = windows, bases, progress
        self._stamps = StampSpacing(windows)
        self._histories: dict[int, History] = {}
        self._structure_weight: Floats | None = None

    def record(self, i: int, nis: float, weight: float, belief: Belief) -> None:
        """Write the row of window i: its NIS before it was learned, its weight, the belief after it."""
        rows, belief = self._rows(belief), self._stamps.supported(belief, i + 1)
        rows.mean[i], rows.std[i] = belief.mean, np.sqrt(np.diag(belief.covariance))
        rows.nis[i], rows.weight[i], rows.basis_weight[i] = nis, weight, belief.weights
        if self._progress is not None and i % 50 == 0:
            self._progress((i + 1) / len(rows.t))

    def mark(self, i: int, change: _core.ChangeTest, belief: Belief) -> None:
        """Write into the row of window i whether the ground changed, as the belief's structure sees it."""
        rows = self._rows(belief)
        rows.change[i], rows.alarm[i] = change.log_odds, change.alarm

    def weigh(self, i: int, weights: Floats) -> None:
        """Write the weights of the structures after window i."""
        if self._structure_weight is None:
            self._structure_weight = np.zeros((len(self._windows), len(weights)))
        self._structure_weight[i] = weights

    def history(self, last: Belief) -> History:
        """Return the history of the structure that the last belief comes from, with the weights of all."""
        rows = self._rows(last)
        if self._structure_weight is None:
            return rows
        return replace(rows, structures=STRUCTURES, structure_weight=self._structure_weight)

    def _rows(self, belief: Belief) -> History:
        if belief.structure not in self._histories:
            self._histories[belief.structure] = self._empty(belief.motion)
        return self._histories[belief.structure]

    def _empty(self, motion: _core.MotionModel) -> History:
        windows, names = self._windows, tuple(info.name for info in motion.parameters)
        count = len(windows)
        return History(
            run=np.array([windows.drive[p].index for p in windows.position], dtype=np.int64),
            t=windows.end,
            names=names,
            mean=np.zeros((count, len(names))),
            std=np.zeros((count, len(names))),
            nis=np.zeros(count),
            weight=np.zeros(count),
            bases=self._bases,
            basis_weight=np.zeros((count, len(self._bases))),
            change=np.zeros(count),
            alarm=np.zeros(count, dtype=np.bool_),
        )
