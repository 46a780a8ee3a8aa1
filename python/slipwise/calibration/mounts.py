# SPDX-License-Identifier: Apache-2.0
"""Where further sources of poses sit beside the first, and how much later they are stamped.

A drive is cut into windows of ten seconds. In each, the track of the further source is laid on that of the
first, whatever frame it is in: what remains says where the source sits on the robot, how it is turned and how
late its stamps are. A source that drifts over more than a window does no harm, and no motion model is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.export.mounts import Mounted
from slipwise.logs.log import Poses, Run

Floats = NDArray[np.float64]

X, Y, YAW, LATE = range(4)
_WINDOW = 10.0  # s
_FARTHEST_WAY = 1e4  # m within a window
_FEWEST_POSES, _FEWEST_WINDOWS = 8, 6
_LONGEST_STEP = 0.35  # s between poses of the first source, on a straight line between which others are
_LATEST = 1.0  # s
_TELLING = 16.0  # times the prior's information, from which on windows tell something
_FARTHEST = np.array([50.0, 50.0, np.pi, _LATEST])  # m, m, rad, s
_GRID = np.arange(-_LATEST + 0.1, _LATEST, 0.2)  # s, where the search for the lateness begins
_PRIOR_STD = np.array([2.0, 2.0, 1.0, 0.5])  # m, m, rad, s: where the drive says nothing
_AROUND = (-0.2, -0.1, 0.0, 0.1, 0.2)  # s
_STEP = 0.2  # s of the differences that stand for speeds; shorter ones are those of the noise
_ROUNDS = 8
_MOST_POSES = 20000  # of a source, evenly taken
_OUTLIER = 4.0  # times the usual error of a window, from which on it is left out
_LEAST_NOISE = (1e-4, 1e-4)  # m, rad
_KNOWN = (0.1, 0.1, 0.1, 0.1)  # m, m, rad, s: standard deviations up to which a number is said


@dataclass(frozen=True, eq=False)
class Mount:
    """The pose of a source in base_link, and its lateness beside the first source."""

    name: str
    beside: str  # name of the first source
    value: Floats  # [4] x ahead, y to the left [m], yaw [rad], lateness of the stamps [s]
    covariance: Floats  # [4, 4]
    seconds: float  # of driving that both saw
    heading: bool  # whether it measures headings; without them, its yaw says nothing

    def mounted(self) -> Mounted:
        """Return what the drive tells of it."""
        known = [
            (float(value), float(std)) if std <= most else None
            for value, std, most in zip(self.value, self.std, _KNOWN, strict=True)
        ]
        return Mounted(self.name, known[X], known[Y], known[YAW] if self.heading else None, known[LATE])

    def sentence(self) -> str:
        """Say where the source sits, and what the drive does not tell of it."""
        found = self.mounted()
        said = found.sentence()
        if not said:
            return f"{self.seconds:.0f} s do not tell where {self.name} sits beside {self.beside}: turn more"
        unknown = [
            what
            for what, place in (("how far ahead", found.x), ("how far to a side", found.y))
            if place is None
        ]
        rest = f"; it turned too little to tell {' and '.join(unknown)} it sits" if unknown else ""
        return f"{said}, by {self.seconds:.0f} s beside {self.beside or 'the first source'}{rest}"

    @property
    def std(self) -> Floats:
        """Standard deviations, [4]."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True, eq=False)
class _First:
    """The poses of base_link by the first source, on straight lines between its stamps."""

    t: Floats
    x: Floats
    y: Floats
    yaw: Floats  # not wrapped

    def at(self, t: Floats) -> Floats:
        return np.column_stack([np.interp(t, self.t, each) for each in (self.x, self.y, self.yaw)])

    def smooth(self, t: Floats) -> Floats:
        """Return means over some tenths of a second: derivatives must not be those of the noise."""
        found: Floats = np.mean([self.at(t + offset) for offset in _AROUND], axis=0)
        return found

    def halves(self) -> tuple[_First, _First]:
        """Return every other pose: what is noise is not the same in both."""
        even, odd = (_First(self.t[k::2], self.x[k::2], self.y[k::2], self.yaw[k::2]) for k in (0, 1))
        return even, odd


@dataclass(frozen=True, eq=False)
class _Window:
    """Poses of a further source, while the first one is there."""

    first: _First
    halves: tuple[_First, _First]
    t: Floats
    x: Floats
    y: Floats
    yaw: Floats


@dataclass(frozen=True, eq=False)
class _Left:
    """What is left of a window, with its frame fitted: rows of (x, y[, yaw]) after one another."""

    rows: Floats  # [R]
    jacobian: Floats  # [R, 4]
    information: Floats  # [4, 4] derivatives of one half of the first source's poses times those of the other
    headings: NDArray[np.bool_]  # [R]


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


def _mount(name: str, beside: str, runs: Sequence[Run], place: tuple[float, float, float]) -> Mount | None:
    windows = [
        window for run in runs if name in run.others for window in _windows(run, run.others[name], place)
    ]
    if len(windows) < _FEWEST_WINDOWS:
        return None
    heading = not any(run.others[name].course for run in runs if name in run.others)
    starts = [np.array([0.0, 0.0, 0.0, late]) for late in _GRID]
    few = windows[:: max(1, len(windows) // 12)]
    best = min((_rough(few, start, heading=heading) for start in starts), key=lambda each: each[0])[1]
    value, covariance = _fit(windows, best, heading=heading)
    seconds = sum(float(window.t[-1] - window.t[0]) for window in windows)
    return Mount(name, beside, value, covariance, seconds, heading)


def _windows(run: Run, other: Poses, place: tuple[float, float, float]) -> list[_Window]:
    first = run.poses
    if (
        len(other) < _FEWEST_POSES
        or len(first) < _FEWEST_POSES
        or float(np.median(np.diff(first.t))) > _LONGEST_STEP
    ):
        return []
    yaw = np.unwrap(first.yaw) - place[2]
    ahead, left = place[:2]
    x = first.x - (ahead * np.cos(yaw) - left * np.sin(yaw))
    y = first.y - (ahead * np.sin(yaw) + left * np.cos(yaw))
    base = _First(first.t, x, y, yaw)
    halves = base.halves()
    broken = (np.diff(first.t) > 2.0 * _LONGEST_STEP) | (np.diff(first.frame) != 0)
    breaks = np.append(0, np.cumsum(broken))  # of the stretch that each pose is in
    before = np.searchsorted(first.t, other.t - _LATEST, side="right") - 1
    after = np.searchsorted(first.t, other.t + _LATEST)
    inside = (before >= 0) & (after < len(first))
    inside[inside] = breaks[before[inside]] == breaks[after[inside]]
    inside[np.arange(len(other)) % max(1, len(other) // _MOST_POSES) != 0] = False
    stretch = np.where(inside, breaks[np.clip(before, 0, None)], -1)
    slot = np.floor((other.t - other.t[0]) / _WINDOW) if len(other) else other.t
    keys = np.column_stack((slot, other.frame, stretch))
    changes = np.flatnonzero((np.diff(keys, axis=0) != 0).any(axis=1)) + 1
    parts = [part for part in np.split(np.arange(len(other)), changes) if len(part) >= _FEWEST_POSES]
    return [
        _Window(base, halves, other.t[part], other.x[part], other.y[part], other.yaw[part])
        for part in parts
        if inside[part].all() and _moves(other.x[part], other.y[part])
    ]


def _moves(x: Floats, y: Floats) -> bool:
    """Whether positions are those of a robot that drives, and of numbers that can be reckoned with."""
    way = float(np.hypot(np.ptp(x), np.ptp(y)))
    return 0.0 < way < _FARTHEST_WAY


def _left(window: _Window, state: Floats, noise: Floats, *, heading: bool) -> _Left:
    """Fit the frame of a window, and return what is left, over its noise, with derivatives by the state."""
    at = window.t - state[LATE]
    pose = window.first.at(at)
    cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    arm = np.column_stack((cos * state[X] - sin * state[Y], sin * state[X] + cos * state[Y]))
    seen, turned = pose[:, :2] + arm, pose[:, 2] + state[YAW]
    residual, frame = _laid(window, seen, turned if heading else None, noise)
    q, _ = np.linalg.qr(frame)

    def without_frame(rows: Floats) -> Floats:
        return rows - q @ (q.T @ rows)

    one, other = (
        without_frame(_derivatives(half, at, state, noise, heading=heading)) for half in window.halves
    )
    headings = np.arange(len(residual)) >= 2 * len(at)
    information = 0.5 * (one.T @ other + other.T @ one)
    return _Left(without_frame(residual), 0.5 * (one + other), information, headings)


def _laid(window: _Window, seen: Floats, turned: Floats | None, noise: Floats) -> tuple[Floats, Floats]:
    """Lay a window's poses on where its sensor was seen [N, 2], and on headings [N] where there are some.

    Returns what is left, over its noise, and its derivatives by the frame: two shifts and a turn.
    """
    measured = np.column_stack((window.x, window.y))
    goal = seen.mean(axis=0)
    flat, target = measured - measured.mean(axis=0), seen - goal
    cross = (flat[:, 0] * target[:, 1] - flat[:, 1] * target[:, 0]).sum()
    turn = float(np.arctan2(cross, (flat * target).sum()))
    if turned is not None:
        turn = float(np.angle(np.exp(1j * (turned - window.yaw)).mean()))
    count = len(window.t)
    rows, frame = np.empty(0), np.empty((0, 3))
    for _ in range(3):  # the turn of the frame is no linear parameter
        c, s = np.cos(turn), np.sin(turn)
        laid = flat @ np.array([[c, s], [-s, c]])
        rows = (laid - target).T.ravel() / noise[0]
        frame = np.zeros((2 * count, 3))
        frame[:count, 0] = frame[count:, 1] = 1.0
        frame[:, 2] = np.concatenate((-laid[:, 1], laid[:, 0]))
        frame /= noise[0]
        if turned is not None:
            rows = np.append(rows, np.angle(np.exp(1j * (window.yaw + turn - turned))) / noise[1])
            frame = np.vstack((frame, np.tile((0.0, 0.0, 1.0 / noise[1]), (count, 1))))
        turn -= float(np.linalg.lstsq(frame, rows, rcond=None)[0][2])
    return rows, frame


def _derivatives(first: _First, at: Floats, state: Floats, noise: Floats, *, heading: bool) -> Floats:
    """Return how rows of (x, y[, yaw]) move with the state, over their noise."""
    speed = (first.smooth(at + _STEP) - first.smooth(at - _STEP)) / (2.0 * _STEP)
    yaw = first.smooth(at)[:, 2]
    cos, sin, zero = np.cos(yaw), np.sin(yaw), np.zeros(len(at))
    arm = np.column_stack((cos * state[X] - sin * state[Y], sin * state[X] + cos * state[Y]))
    by_arm = (np.column_stack((cos, -sin)), np.column_stack((sin, cos)))  # of x and of y, by (x, y)
    velocity = speed[:, :2] + speed[:, 2:] * np.column_stack((-arm[:, 1], arm[:, 0]))
    parts = [np.column_stack((-by_arm[axis], zero, velocity[:, axis])) / noise[0] for axis in (0, 1)]
    if heading:
        parts.append(np.column_stack((zero, zero, zero - 1.0, speed[:, 2])) / noise[1])
    return np.concatenate(parts)


def _rough(windows: Sequence[_Window], start: Floats, *, heading: bool) -> tuple[float, Floats]:
    """Return how badly windows fit, in metres and half radians, and where, from one lateness."""
    state, noise = start.copy(), np.array((0.1, 0.05))
    cost = np.inf
    for _ in range(3):
        left = [_left(window, state, noise, heading=heading) for window in windows]
        cost = float(np.mean([np.mean(each.rows**2) for each in left]))
        state = _moved(left, state)
    return cost, state


def _fit(windows: Sequence[_Window], start: Floats, *, heading: bool) -> tuple[Floats, Floats]:
    """Return the state and its covariance, which follows from how the windows scatter where that is more."""
    state, noise = start, np.array((0.05, 0.02))
    covariance, scatter = np.eye(4), np.eye(4)
    for _ in range(_ROUNDS):
        left = [_left(window, state, noise, heading=heading) for window in windows]
        sizes = np.array([np.sqrt(np.mean(each.rows**2)) for each in left])
        kept = [each for each, size in zip(left, sizes, strict=True) if size <= _OUTLIER * np.median(sizes)]
        state, covariance = _moved(kept, state), _covariance(kept)
        gradients = [each.jacobian.T @ each.rows for each in kept]
        scatter = sum((np.outer(each, each) for each in gradients), np.zeros((4, 4)))
        noise = _noise(kept, noise)
    count = len(windows)
    wider = np.trace(covariance @ scatter) / 4.0 * count / max(count - 4, 1)
    return state, covariance * max(wider, 1.0)


def _information(left: Sequence[_Left]) -> tuple[Floats, Floats]:
    """Return what windows tell of the state over its prior, by direction: values [4] and vectors [4, 4]."""
    scale = np.outer(_PRIOR_STD, _PRIOR_STD)
    values, vectors = np.linalg.eigh(sum((each.information for each in left), np.zeros((4, 4))) * scale)
    return np.maximum(values, 0.0), vectors


def _moved(left: Sequence[_Left], state: Floats) -> Floats:
    """Return the next state: along directions of which the windows tell nothing it is that of the prior."""
    values, vectors = _information(left)
    start = state / _PRIOR_STD
    gradient = sum((each.jacobian.T @ each.rows for each in left), np.zeros(4)) * _PRIOR_STD
    along = vectors.T @ (gradient + start) / (values + 1.0)
    along = np.where(values > _TELLING, along, vectors.T @ start)
    moved: Floats = np.clip(_PRIOR_STD * (start - vectors @ along), -_FARTHEST, _FARTHEST)
    return moved


def _covariance(left: Sequence[_Left]) -> Floats:
    values, vectors = _information(left)
    found: Floats = (vectors / (values + 1.0)) @ vectors.T * np.outer(_PRIOR_STD, _PRIOR_STD)
    return found


def _noise(left: Sequence[_Left], noise: Floats) -> Floats:
    """Return errors of positions [m] and headings [rad]; the frame took three numbers of each window."""
    found = noise.copy()
    for k, headings in enumerate((False, True)):
        rows = np.concatenate([each.rows[each.headings == headings] for each in left])
        if len(rows):
            free = max(1.0 - 3.0 * len(left) / sum(len(each.rows) for each in left), 0.1)
            found[k] = max(noise[k] * float(np.sqrt(np.mean(rows**2) / free)), _LEAST_NOISE[k])
    return found
