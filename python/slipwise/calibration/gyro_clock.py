# SPDX-License-Identifier: Apache-2.0
"""How much later a gyro beside poses is stamped, and how far it turns: nothing is learned from it.

In windows of ten seconds the headings of the poses are fitted by the integral of the gyro's rates, shifted
and scaled; where a window begins and the gyro's bias in it are free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.gyro import COLUMN, Turned, turned_by
from slipwise.logs.log import Run
from slipwise.logs.readings import number_rows
from slipwise.number_text import estimate_text

Floats = NDArray[np.float64]

_WINDOW = 10.0  # s
_FEWEST_POSES, _FEWEST_WINDOWS = 8, 6
_LATEST = 1.0  # s
_GRID = np.arange(-_LATEST + 0.1, _LATEST, 0.1)  # s, where the search begins
_AROUND = np.arange(-2, 3) * 0.05  # s, over which a rate is a mean: the derivative must not be noise
_ROUNDS = 4
_WORST = 1e12  # condition, beyond which the drive tells nothing
_ROUGH = 10  # windows by which the search begins
_OUTLIER = 4.0  # times the usual error of a window, from which on it is left out
_TURNS = 0.1  # rad, less of a window says nothing
_CLEAR, _SAME = 3.0, (0.02, 0.02)  # standard deviations; s, and of the scale: what is not worth a word
_KNOWN = (0.05, 0.05)  # s, and of the scale: standard deviations up to which they are said


@dataclass(frozen=True)
class GyroClock:
    """What a gyro says beside the poses; standard deviations stand behind the numbers."""

    late: tuple[float, float]  # s by which its stamps are later than those of the poses
    scale: tuple[float, float]  # how far it turns, over what the poses turn

    def sentence(self) -> str:
        """Say what is clearly otherwise than with a gyro that agrees; empty where nothing is."""
        said = []
        if self.late[1] <= _KNOWN[0] and abs(self.late[0]) > max(_CLEAR * self.late[1], _SAME[0]):
            order = "later" if self.late[0] >= 0.0 else "earlier"
            said.append(
                f"is stamped {estimate_text(abs(self.late[0]), self.late[1])} s {order} than the poses"
            )
        if self.scale[1] <= _KNOWN[1] and abs(self.scale[0] - 1.0) > max(_CLEAR * self.scale[1], _SAME[1]):
            said.append(f"turns {estimate_text(*self.scale)} times as far")
        return f"the gyro {' and '.join(said)}" if said else ""


@dataclass(frozen=True, eq=False)
class _Window:
    t: Floats  # of the poses
    yaw: Floats
    gyro: Turned  # of all of the run

    def left(self, late: float, scale: float) -> Floats:
        """Return what is left of the headings [N]."""
        return self._rest(self.yaw - self.gyro.at(self.t + late) / scale)

    def derivatives(self, late: float, scale: float) -> Floats:
        """Return derivatives of what is left by lateness and scale [N, 2]."""
        at = self.t + late
        ahead, behind = (
            np.mean([self.gyro.at(at + side + by) for by in _AROUND], axis=0) for side in (0.05, -0.05)
        )
        rate = (ahead - behind) / 0.1
        return self._rest(np.column_stack((rate / scale, -self.gyro.at(at) / scale**2)))

    @cached_property
    def _free(self) -> Floats:
        """A heading and a bias of the gyro, which are free, as orthogonal columns [N, 2]."""
        return np.linalg.qr(np.column_stack((np.ones(len(self.t)), self.t - self.t.mean())))[0]

    def _rest(self, rows: Floats) -> Floats:
        return rows - self._free @ (self._free.T @ rows)


def gyro_clock(runs: Sequence[Run]) -> GyroClock | None:
    """Return how late a gyro beside poses with headings is; None where too few windows say it."""
    windows = [window for run in runs for window in _windows(run)]
    if len(windows) < _FEWEST_WINDOWS:
        return None
    some = windows[:: max(1, len(windows) // _ROUGH)]
    costs = [sum(float(np.sum(w.left(late, 1.0) ** 2)) for w in some) for late in _GRID]
    state = np.array((float(_GRID[int(np.argmin(costs))]), 1.0))
    variances = np.ones(2)
    for _ in range(_ROUNDS):
        late, scale = state.tolist()
        parts = [(window.left(late, scale), window.derivatives(late, scale)) for window in windows]
        sizes = np.array([np.sqrt(np.mean(rows**2)) for rows, _ in parts])
        kept = [part for part, size in zip(parts, sizes, strict=True) if size <= _OUTLIER * np.median(sizes)]
        information = sum((j.T @ j for _, j in kept), np.zeros((2, 2)))
        if not (np.isfinite(information).all() and np.linalg.cond(information) < _WORST):
            return None
        gradients = [j.T @ rows for rows, j in kept]
        state = state + np.linalg.solve(information, sum(gradients, np.zeros(2)))
        if not (abs(state[0]) < _LATEST and 0.5 < state[1] < 2.0):
            return None
        scatter = sum((np.outer(g, g) for g in gradients), np.zeros((2, 2)))
        count, samples = len(kept), sum(len(rows) for rows, _ in kept)
        inverse = np.linalg.inv(information)
        variance = sum(float(rows @ rows) for rows, _ in kept) / max(samples - 2 * count - 2, 1)
        scattered = inverse @ scatter @ inverse * count / max(count - 2, 1)
        variances = np.maximum(np.diag(inverse) * variance, np.diag(scattered))
    stds = np.sqrt(variances).tolist()
    return GyroClock((float(state[0]), stds[0]), (float(state[1]), stds[1]))


def _windows(run: Run) -> list[_Window]:
    gyro, poses = turned_by(number_rows(run, COLUMN)), run.poses
    if poses.course or len(poses) < _FEWEST_POSES or gyro is None:
        return []
    inside = gyro.known(poses.t, _LATEST + 0.2)
    slot = np.floor((poses.t - poses.t[0]) / _WINDOW)
    changes = np.flatnonzero((np.diff(slot) != 0) | (np.diff(poses.frame) != 0)) + 1
    yaw = np.unwrap(poses.yaw)
    return [
        _Window(poses.t[part], yaw[part], gyro)
        for part in np.split(np.arange(len(poses)), changes)
        if len(part) >= _FEWEST_POSES and inside[part].all() and np.ptp(yaw[part]) > _TURNS
    ]
