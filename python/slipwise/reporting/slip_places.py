# SPDX-License-Identifier: Apache-2.0
"""Slip by place: what a model did not expect of the motion, gathered in the cells of a grid over the path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.predictions import Predictions
from slipwise.logs.log import Poses

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CHANNELS = {"forward": 0, "yaw": 2}  # of the chart (x, y, yaw)
_ACROSS = 24  # cells along the longer side, at most
_FEWEST = 3  # windows of a cell that is shown
_AWAY = 10.0  # s between two visits to a cell that are two passes
_LEAST_PASSES = 8  # cells passed twice, from which their agreement is computed


@dataclass(frozen=True, eq=False)
class SlipPlaces:
    """Cells of one frame, [C] each; `percent` and `std` are of what was driven."""

    channel: str
    size: float  # m, of a cell
    x: Floats  # m, of the middle
    y: Floats
    percent: Floats  # measured less predicted, along the way that was predicted: negative slips more
    std: Floats
    windows: Ints
    passes: Ints
    agreement: float | None  # correlation of first and later passes over the same cells; None: too few cells


def slip_places(poses: Poses, part: Predictions, run: int, channel: str) -> SlipPlaces | None:
    """Gather the windows of a run in cells; None where no cell has enough.

    The estimate of a cell is sum(r d) / sum(d^2), the least squares of r, measured less predicted, on d,
    what was predicted. Its standard deviation is that of least squares, with the variance of all windows
    about their cells, or that of the passes' own estimates about it where they differ more: windows that
    follow each other are not independent.

    Args:
        poses: of the run, in one frame.
        part: predictions of one method over a short horizon.
        run: index of the run.
        channel: one of CHANNELS.
    """
    here = np.flatnonzero((part.run == run) & (part.t_start >= poses.t[0]) & (part.t_end <= poses.t[-1]))
    if len(here) < _FEWEST:
        return None
    middle = 0.5 * (part.t_start + part.t_end)[here]
    x, y = np.interp(middle, poses.t, poses.x), np.interp(middle, poses.t, poses.y)
    driven = np.hypot(part.measured[here, 0], part.measured[here, 1])
    size = max(max(np.ptp(poses.x), np.ptp(poses.y)) / _ACROSS, float(np.median(driven)), 1e-3)
    column = np.floor((x - poses.x.min()) / size).astype(np.int64)
    row = np.floor((y - poses.y.min()) / size).astype(np.int64)
    of_cell, place = np.unique(np.column_stack((column, row)), axis=0, return_inverse=True)
    d, r = part.pose[here, CHANNELS[channel]], part.residual[here, CHANNELS[channel]]
    cells = [_cell(middle[at], d[at], r[at]) for at in _members(place.ravel(), len(of_cell))]
    kept = [k for k, cell in enumerate(cells) if cell is not None]
    found = [cell for cell in cells if cell is not None]
    if not found:
        return None
    variance = sum(cell.left for cell in found) / sum(cell.windows - 1 for cell in found)
    low = np.array([poses.x.min(), poses.y.min()])
    centre = low + (of_cell[kept] + 0.5) * size
    return SlipPlaces(
        channel=channel,
        size=size,
        x=centre[:, 0],
        y=centre[:, 1],
        percent=np.array([100.0 * cell.mean for cell in found]),
        std=np.array([100.0 * cell.std(variance) for cell in found]),
        windows=np.array([cell.windows for cell in found], dtype=np.int64),
        passes=np.array([len(cell.of_pass) for cell in found], dtype=np.int64),
        agreement=_agreement(found),
    )


@dataclass(frozen=True)
class _Cell:
    mean: float
    square: float  # sum of d^2
    left: float  # sum of squares about the mean
    windows: int
    of_pass: tuple[float, ...]

    def std(self, variance: float) -> float:
        """Return the standard deviation of the mean, given the variance of one window."""
        passes = len(self.of_pass)
        apart = float(np.std(self.of_pass, ddof=1)) / passes**0.5 if passes > 1 else 0.0
        return max(float(np.sqrt(variance / self.square)), apart)


def _members(place: Ints, count: int) -> list[Ints]:
    return [np.flatnonzero(place == k) for k in range(count)]


def _cell(t: Floats, d: Floats, r: Floats) -> _Cell | None:
    """Least squares of `r` on `d`; None where nothing was driven in this channel, or windows are too few."""
    square = float(d @ d)
    if len(t) < _FEWEST or square <= 0.0:
        return None
    mean = float(r @ d) / square
    left = float(((r - mean * d) ** 2).sum())
    passes = np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) > _AWAY) + 1)
    of_pass = tuple(float(r[p] @ d[p] / (d[p] @ d[p])) for p in passes if d[p] @ d[p] > 0.0)
    return _Cell(mean, square, left, len(t), of_pass)


def _agreement(cells: list[_Cell]) -> float | None:
    """Correlation over cells of the first pass and the mean of others: 1 where slip is the place's own."""
    twice = [(cell.of_pass[0], float(np.mean(cell.of_pass[1:]))) for cell in cells if len(cell.of_pass) > 1]
    if len(twice) < _LEAST_PASSES:
        return None
    first, later = np.array(twice).T
    if not first.std() or not later.std():
        return None
    return float(np.corrcoef(first, later)[0, 1])
