# SPDX-License-Identifier: Apache-2.0
"""Where further sources of poses sit beside the first, and how much later they are stamped.

A drive is cut into windows of ten seconds. In each, the track of the further source is laid on that of the
first, whatever frame it is in: what remains says where the source sits on the robot, how it is turned and how
late its stamps are. A source that drifts over more than a window does no harm, and no motion model is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.mount_windows import LATEST, YAW, Left, Windows, X, Y, left_of_all, windows_in
from slipwise.logs.log import Run
from slipwise.models.model import Model
from slipwise.models.mounted import KNOWN, UNITS, Mounted, mount_row
from slipwise.models.parameter_table import ParameterTable

Floats = NDArray[np.float64]

_FEWEST_WINDOWS = 6
_MOST_STRETCHES = 6  # of a source, that a stream keeps
_TELLING = 16.0  # times the prior's information, from which on windows tell something
_FARTHEST = np.array([50.0, 50.0, np.pi, LATEST])  # m, m, rad, s
_GRID = np.arange(-LATEST + 0.1, LATEST, 0.2)  # s, where the search for the lateness begins
_PRIOR_STD = np.array([2.0, 2.0, 1.0, 0.5])  # m, m, rad, s: where the drive says nothing
_ROUNDS = 8
_ROUGH = (12, 50)  # windows and poses in each, by which the search begins
_OUTLIER = 4.0  # times the usual error of a window, from which on it is left out
_MOST_ALIKE = 0.8  # correlation of neighbouring windows
_LEAST_NOISE = (1e-4, 1e-4)  # m, rad


@dataclass(frozen=True, eq=False)
class Mount:
    """The pose of a source in base_link, and its lateness beside the first source."""

    name: str
    beside: str  # name of the first source
    value: Floats  # [4] x ahead, y to the left [m], yaw [rad], lateness of the stamps [s]
    covariance: Floats  # [4, 4]
    seconds: float  # of driving that both saw
    heading: bool  # whether it measures headings; without them, its yaw says nothing

    @property
    def known(self) -> list[int]:
        """Which of the numbers the drive tells."""
        known = np.flatnonzero(self.std <= KNOWN).tolist()
        return [i for i in known if i != YAW or self.heading]

    def mounted(self) -> Mounted:
        """Return what the drive tells of it."""
        x, y, yaw, late = (
            (float(self.value[i]), float(self.std[i])) if i in self.known else None for i in range(4)
        )
        return Mounted(self.name, x, y, yaw, late)

    def added_to(self, table: ParameterTable) -> ParameterTable:
        """Return the table of a model with what the drive tells of it."""
        estimates = list(zip(self.value.tolist(), self.std.tolist(), strict=True))
        rows = [
            mount_row(self.name, self.beside, list(UNITS)[i], estimates[i], float(_PRIOR_STD[i]))
            for i in self.known
        ]
        return table.beside(rows, self.covariance[np.ix_(self.known, self.known)])

    def untold(self) -> str:
        """Say what the drive does not tell of where it sits; empty where it tells it."""
        places = (("how far ahead", X), ("how far to a side", Y))
        unknown = [what for what, place in places if place not in self.known]
        if not unknown:
            return ""
        beside = self.beside or "the first source"
        why = "turn more, or look whether both are of this robot and their headings are right"
        where = f"{' and '.join(unknown)} {self.name} sits"
        return f"{self.seconds:.0f} s beside {beside} do not tell {where}: {why}"

    @property
    def std(self) -> Floats:
        """Standard deviations, [4]."""
        return np.sqrt(np.diag(self.covariance))


def mounts_of(runs: Sequence[Run], place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[Mount, ...]:
    """Return the mounts of all sources beside the first; of those that too few windows show, none.

    Args:
        runs: of a log.
        place: where the first source sits in base_link (x, y [m], yaw [rad]).
    """
    if not runs or any(run.poses.course for run in runs):
        return ()
    names = dict.fromkeys(name for run in runs for name in run.others)
    beside = next((run.source for run in runs if run.source), "")
    found = (_mount(name, beside, runs, place) for name in names)
    return tuple(each for each in found if each is not None)


class MountWatch:
    """Where further sources sit while they are driven: some stretches are kept, the older the fewer.

    Args:
        place: where the first source sits in base_link (x, y [m], yaw [rad]).
    """

    def __init__(self, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        self._place = place
        self._windows: dict[tuple[str, bool], list[Windows]] = {}  # by the name, and whether it has headings
        self._seconds: dict[tuple[str, bool], float] = {}
        self._until = -np.inf  # s, when the last stretch ended
        self._beside = ""
        self._found: dict[tuple[str, bool], Mount] = {}

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._until = -np.inf

    def take(self, stretch: Run) -> None:
        """Take the newest stretch of a run; of what was taken before, nothing is taken again."""
        if stretch.poses.course or not len(stretch.poses):
            return
        self._beside = stretch.source
        for name, poses in stretch.others.items():
            found = windows_in(stretch, poses, self._place) if len(poses) else None
            if found is None:
                continue
            new = found.begins() >= self._until
            if new.any():
                self._keep((name, not poses.course), found.some(new, len(poses)))
        self._until = max(self._until, float(stretch.poses.t[-1]) - 2.0 * LATEST)

    def mounts(self) -> tuple[Mount, ...]:
        """Return the mounts by all that is kept; of those that too few windows show, none."""
        for which, windows in self._windows.items():
            name, heading = which
            before = self._found.get(which)
            start = None if before is None or before.untold() else before.value
            found = _mount_by(name, self._beside, windows, start, heading=heading)
            if found is not None:
                self._found[which] = replace(found, seconds=self._seconds[which])
        return tuple(self._found.values())

    def _keep(self, which: tuple[str, bool], windows: Windows) -> None:
        kept = self._windows.setdefault(which, [])
        kept.append(windows)
        self._seconds[which] = self._seconds.get(which, 0.0) + windows.seconds()
        if len(kept) > _MOST_STRETCHES:
            del kept[1:-1:2]


def holding_mounts(model: Model, mounts: Sequence[Mount]) -> Model:
    """Return the model with what the drive tells of the mounts as rows."""
    table = model.table
    for mount in mounts:
        table = mount.added_to(table)
    return model.with_table(table) if mounts else model


def _mount(name: str, beside: str, runs: Sequence[Run], place: tuple[float, float, float]) -> Mount | None:
    found = (windows_in(run, run.others[name], place) for run in runs if name in run.others)
    windows = [each for each in found if each is not None]
    heading = not any(run.others[name].course for run in runs if name in run.others)
    return _mount_by(name, beside, windows, heading=heading)


def _mount_by(
    name: str, beside: str, windows: Sequence[Windows], start: Floats | None = None, *, heading: bool
) -> Mount | None:
    """Return the mount by these windows, looked for around a start where there is one."""
    if sum(map(len, windows)) < _FEWEST_WINDOWS:
        return None
    if start is None:
        few, starts = _few(windows), [np.array([0.0, 0.0, 0.0, late]) for late in _GRID]
        start = min((_rough(few, each, heading=heading) for each in starts), key=lambda each: each[0])[1]
    value, covariance = _fit(windows, start, heading=heading)
    return Mount(name, beside, value, covariance, sum(each.seconds() for each in windows), heading)


def _few(windows: Sequence[Windows]) -> list[Windows]:
    """Return some windows of all runs, with few poses: enough to begin with."""
    ends = np.cumsum([len(each) for each in windows])
    step = max(1, int(ends[-1]) // _ROUGH[0])
    chosen = np.split(np.arange(ends[-1]) % step == 0, ends[:-1])
    return [each.some(taken, _ROUGH[1]) for each, taken in zip(windows, chosen, strict=True) if taken.any()]


def _rough(windows: Sequence[Windows], start: Floats, *, heading: bool) -> tuple[float, Floats]:
    """Return how badly windows fit, in metres and half radians, and where, from one lateness."""
    state, noise = start.copy(), np.array((0.1, 0.05))
    cost = np.inf
    for _ in range(3):
        left = left_of_all(windows, state, noise, heading=heading)
        cost = float(np.mean(left.sizes))
        state = _moved(left, state)
    return cost, state


def _fit(windows: Sequence[Windows], start: Floats, *, heading: bool) -> tuple[Floats, Floats]:
    """Return the state and its covariance, which follows from how the windows scatter where that is more."""
    state, noise = start, np.array((0.05, 0.02))
    covariance, gradients = np.eye(4), np.zeros((1, 4))
    for _ in range(_ROUNDS):
        left = left_of_all(windows, state, noise, heading=heading)
        sizes = np.sqrt(left.sizes)
        kept = left.some(sizes <= _OUTLIER * np.median(sizes))
        state, covariance, gradients = _moved(kept, state), _covariance(kept), kept.gradient
        noise = _noise(kept, noise)
    return state, _widened(covariance, gradients)


def _widened(covariance: Floats, gradients: Floats) -> Floats:
    """Return the covariance of white noise, each number's wider where the windows say so.

    Noise that lasts errs otherwise in headings than along the path, so each number has a factor of its own:
    how far windows [W, 4] move it, and how much alike neighbours do, as an autoregression of order one.
    """
    moves = gradients @ covariance
    free = max(len(moves) - 4, 1)
    squares = (moves**2).sum(axis=0)
    alike = (moves[1:] * moves[:-1]).sum(axis=0) / np.maximum(squares, np.finfo(float).tiny)
    alike = np.clip((len(moves) * alike + 1.0) / free, 0.0, _MOST_ALIKE)  # few windows seem less alike
    factors = squares / np.diag(covariance) * len(moves) / free * (1.0 + alike) / (1.0 - alike)
    stds = np.sqrt(np.maximum(factors, 1.0))
    return covariance * np.outer(stds, stds)


def _information(left: Left) -> tuple[Floats, Floats]:
    """Return what windows tell of the state over its prior, by direction: values [4] and vectors [4, 4]."""
    scale = np.outer(_PRIOR_STD, _PRIOR_STD)
    values, vectors = np.linalg.eigh(left.information.sum(axis=0) * scale)
    return np.maximum(values, 0.0), vectors


def _moved(left: Left, state: Floats) -> Floats:
    """Return the next state: along directions of which the windows tell nothing it is that of the prior."""
    values, vectors = _information(left)
    start = state / _PRIOR_STD
    gradient = left.gradient.sum(axis=0) * _PRIOR_STD
    along = vectors.T @ (gradient + start) / (values + 1.0)
    along = np.where(values > _TELLING, along, vectors.T @ start)
    moved: Floats = np.clip(_PRIOR_STD * (start - vectors @ along), -_FARTHEST, _FARTHEST)
    return moved


def _covariance(left: Left) -> Floats:
    values, vectors = _information(left)
    found: Floats = (vectors / (values + 1.0)) @ vectors.T * np.outer(_PRIOR_STD, _PRIOR_STD)
    return found


def _noise(left: Left, noise: Floats) -> Floats:
    """Return errors of positions [m] and headings [rad]; the frame took three numbers of each window."""
    free = max(1.0 - 3.0 * len(left.counts) / float(left.counts.sum()), 0.1)
    counts, squares = left.counts.sum(axis=0), left.squares.sum(axis=0)
    found = noise * np.sqrt(squares / np.maximum(counts, 1.0) / free)
    return np.where(counts > 0.0, np.maximum(found, _LEAST_NOISE), noise)
