# SPDX-License-Identifier: Apache-2.0
"""Windows of a drive that two sources of poses saw, and what is left where one is laid on the other.

In each, the track of the further source is laid on that of the first, whatever frame it is in: two shifts and
a turn of each window are free. All windows of a run are reckoned with at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Poses, Run

Floats = NDArray[np.float64]
_Number = TypeVar("_Number", bound=np.generic)

X, Y, YAW, LATE = range(4)
LATEST = 1.0  # s
_WINDOW = 10.0  # s
_FARTHEST_WAY = 1e4  # m within a window
_FEWEST_POSES = 8
_LONGEST_STEP = 0.35  # s between poses of the first source, on a straight line between which others are
_AROUND = np.arange(-4, 5) * 0.1  # s
_MEAN = np.array((0, 0, 1, 1, 1, 1, 1, 0, 0)) / 5.0  # of poses around
_SPEED = np.array((-1, -1, -1, -1, 0, 1, 1, 1, 1)) / 5.0 / 0.4  # differences of means 0.4 s apart [1/s]
_MOST_POSES = 20000  # of a source, evenly taken


@dataclass(frozen=True, eq=False)
class _First:
    """The poses of base_link by the first source, on straight lines between its stamps."""

    t: Floats
    pose: Floats  # [3, N] x, y, yaw, which is not wrapped

    @cached_property
    def _place(self) -> NDArray[np.complex128]:
        """Positions as complex numbers: both coordinates are looked up at once."""
        return np.asarray(self.pose[0] + 1j * self.pose[1])

    def at(self, t: Floats) -> Floats:
        """Return poses at times of any shape, [3, ...]."""
        place = np.interp(t, self.t, self._place)
        return np.array((place.real, place.imag, np.interp(t, self.t, self.pose[2])))

    def smooth(self, t: Floats) -> tuple[Floats, Floats]:
        """Return speeds [3, N] and yaws [N], means over some tenths of a second: not those of the noise."""
        around = self.at(t + _AROUND[:, np.newaxis])
        return _SPEED @ around, _MEAN @ around[2]

    def halves(self) -> tuple[_First, _First]:
        """Return every other pose: what is noise is not the same in both."""
        return _First(self.t[::2], self.pose[:, ::2]), _First(self.t[1::2], self.pose[:, 1::2])


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows of a run: poses of a further source after one another, while the first one is there."""

    first: _First
    halves: tuple[_First, _First]
    t: Floats  # [N]
    pose: Floats  # [3, N]
    counts: NDArray[np.int64]  # [W] poses of each

    def __len__(self) -> int:
        return len(self.counts)

    def some(self, chosen: NDArray[np.bool_], poses: int) -> Windows:
        """Return the chosen ones, each with about that many poses, evenly taken."""
        number = np.arange(len(self.t)) - self.each(np.cumsum(self.counts) - self.counts)
        taken = self.each(chosen) & (number % self.each(np.maximum(self.counts // poses, 1)) == 0)
        counts = self.sums(taken.astype(np.int64))[chosen]
        return replace(self, t=self.t[taken], pose=self.pose[:, taken], counts=counts)

    def begins(self) -> Floats:
        """Return the stamps at which windows begin, [W]."""
        found: Floats = self.t[np.cumsum(self.counts) - self.counts]
        return found

    def seconds(self) -> float:
        """Return how much driving they hold."""
        ends = np.cumsum(self.counts)
        return float((self.t[ends - 1] - self.begins()).sum())

    def sums(self, rows: NDArray[_Number]) -> NDArray[_Number]:
        """Return sums over each window, [..., W] of [..., N]."""
        found: NDArray[_Number] = np.add.reduceat(rows, np.cumsum(self.counts) - self.counts, axis=-1)
        return found

    def each(self, values: NDArray[_Number]) -> NDArray[_Number]:
        """Return what belongs to each window beside each of its poses, [..., N] of [..., W]."""
        return np.repeat(values, self.counts, axis=-1)

    def centred(self, rows: Floats) -> Floats:
        """Return rows less their mean over each window."""
        return rows - self.each(self.sums(rows) / self.counts)


@dataclass(frozen=True, eq=False)
class Left:
    """What is left of W windows with their frames fitted, over the noise, and what it says of the state."""

    counts: Floats  # [W, 2] numbers of positions and of headings
    squares: Floats  # [W, 2] sums of what is left of these
    gradient: Floats  # [W, 4]
    information: Floats  # [W, 4, 4] derivatives of one half of the first's poses times those of the other

    @property
    def sizes(self) -> Floats:
        """Return mean squares of the windows, [W]."""
        found: Floats = self.squares.sum(axis=1) / self.counts.sum(axis=1)
        return found

    def some(self, chosen: NDArray[np.bool_]) -> Left:
        """Return the chosen ones."""
        parts = (self.counts, self.squares, self.gradient, self.information)
        return Left(*(part[chosen] for part in parts))


def windows_in(run: Run, other: Poses, place: tuple[float, float, float]) -> Windows | None:
    """Return the windows of a run that tell something of a further source; None where there are none."""
    first = run.poses
    if (
        len(other) < _FEWEST_POSES
        or len(first) < _FEWEST_POSES
        or float(np.median(np.diff(first.t))) > _LONGEST_STEP
    ):
        return None
    yaw = np.unwrap(first.yaw) - place[2]
    ahead, left = place[:2]
    x = first.x - (ahead * np.cos(yaw) - left * np.sin(yaw))
    y = first.y - (ahead * np.sin(yaw) + left * np.cos(yaw))
    base = _First(first.t, np.array((x, y, yaw)))
    broken = (np.diff(first.t) > 2.0 * _LONGEST_STEP) | (np.diff(first.frame) != 0)
    breaks = np.append(0, np.cumsum(broken))  # of the stretch that each pose is in
    before = np.searchsorted(first.t, other.t - LATEST, side="right") - 1
    after = np.searchsorted(first.t, other.t + LATEST)
    inside = (before >= 0) & (after < len(first))
    inside[inside] = breaks[before[inside]] == breaks[after[inside]]
    inside[np.arange(len(other)) % max(1, len(other) // _MOST_POSES) != 0] = False
    stretch = np.where(inside, breaks[np.clip(before, 0, None)], -1)
    slot = np.floor((other.t - other.t[0]) / _WINDOW)
    keys = np.column_stack((slot, other.frame, stretch))
    changes = np.flatnonzero((np.diff(keys, axis=0) != 0).any(axis=1)) + 1
    parts = [
        part
        for part in np.split(np.arange(len(other)), changes)
        if len(part) >= _FEWEST_POSES and inside[part].all() and _moves(other.x[part], other.y[part])
    ]
    if not parts:
        return None
    poses = np.concatenate(parts)
    pose = np.array((other.x, other.y, other.yaw))[:, poses]
    return Windows(base, base.halves(), other.t[poses], pose, np.array([len(part) for part in parts]))


def _moves(x: Floats, y: Floats) -> bool:
    """Whether positions are those of a robot that drives, and of numbers that can be reckoned with."""
    way = float(np.hypot(np.ptp(x), np.ptp(y)))
    return 0.0 < way < _FARTHEST_WAY


def _left(windows: Windows, state: Floats, noise: Floats, *, heading: bool) -> Left:
    """Fit the frames of windows, and return what is left, over its noise, with what it says of the state."""
    at = windows.t - state[LATE]
    weight = np.array((1.0 / noise[0], 1.0 / noise[0], 1.0 / noise[1] if heading else 0.0))
    pose = windows.first.at(at)
    pose[:2] += _arm(pose[2], state)
    pose[2] += state[YAW]
    residual, turn = _laid(windows, pose, weight, heading=heading)
    norm = windows.sums((turn**2).sum(axis=0))

    def without_frame(rows: Floats) -> Floats:
        """Return rows [..., 3, N] less what two shifts and a turn of each window explain of them."""
        rest = rows.copy()
        rest[..., :2, :] = windows.centred(rows[..., :2, :])
        part = windows.each(windows.sums((turn * rest).sum(axis=-2)) / norm)
        rest -= turn * part[..., np.newaxis, :]
        return rest

    rows = without_frame(residual)
    one, other = (without_frame(_derivatives(half, at, state, weight)) for half in windows.halves)
    information = windows.sums(np.einsum("irn,jrn->ijn", one, other)).transpose(2, 0, 1)
    gradient = windows.sums((0.5 * (one + other) * rows).sum(axis=1)).T
    squares = windows.sums(rows**2)
    return Left(
        np.column_stack((2 * windows.counts, windows.counts * heading)).astype(np.float64),
        np.column_stack((squares[0] + squares[1], squares[2])),
        gradient,
        0.5 * (information + information.transpose(0, 2, 1)),
    )


def _arm(yaw: Floats, state: Floats) -> Floats:
    return _turned(state[:2, np.newaxis], np.cos(yaw), np.sin(yaw))


def _turned(vectors: Floats, cos: Floats, sin: Floats) -> Floats:
    """Return vectors [2, N], turned to the left by angles of which these are cosines and sines."""
    return np.array((cos * vectors[0] - sin * vectors[1], sin * vectors[0] + cos * vectors[1]))


def _laid(windows: Windows, seen: Floats, weight: Floats, *, heading: bool) -> tuple[Floats, Floats]:
    """Lay windows on where their sensor was seen [3, N]; its headings count where it measures some.

    Returns what is left, and its derivatives by the turn of the frame, both [3, N] times the weight.
    """
    flat, target = windows.centred(windows.pose[:2]), windows.centred(seen[:2])
    turns = seen[2] - windows.pose[2]
    if heading:
        cos, sin = windows.sums(np.array((np.cos(turns), np.sin(turns))))
    else:
        cross = flat[0] * target[1] - flat[1] * target[0]
        cos, sin = windows.sums(np.array(((flat * target).sum(axis=0), cross)))
    turn = np.arctan2(sin, cos)
    rows, by_turn = np.empty_like(seen), np.empty_like(seen)
    for _ in range(3):  # the turn of the frame is no linear parameter
        angle, cos, sin = windows.each(np.array((turn, np.cos(turn), np.sin(turn))))
        laid = _turned(flat, cos, sin)
        rest = np.mod(angle - turns + np.pi, 2.0 * np.pi) - np.pi
        rows = np.array((*(laid - target), rest)) * weight[:, np.newaxis]
        by_turn = np.array((-laid[1], laid[0], np.ones_like(rest))) * weight[:, np.newaxis]
        turn -= windows.sums((by_turn * rows).sum(axis=0)) / windows.sums((by_turn**2).sum(axis=0))
    return rows, by_turn


def _derivatives(first: _First, at: Floats, state: Floats, weight: Floats) -> Floats:
    """Return how what is left moves with the state, [4, 3, N] times the weight."""
    speed, yaw = first.smooth(at)
    arm = _arm(yaw, state)
    found = np.zeros((4, 3, len(at)))
    found[X, 0], found[X, 1] = -np.cos(yaw), -np.sin(yaw)
    found[Y, 0], found[Y, 1] = -found[X, 1], found[X, 0]
    found[YAW, 2] = -1.0
    found[LATE] = speed
    found[LATE, :2] += speed[2] * np.array((-arm[1], arm[0]))
    found *= weight[:, np.newaxis]
    return found


def left_of_all(windows: Sequence[Windows], state: Floats, noise: Floats, *, heading: bool) -> Left:
    """Return what is left of the windows of several runs."""
    found = [_left(each, state, noise, heading=heading) for each in windows]
    return Left(
        np.concatenate([each.counts for each in found]),
        np.concatenate([each.squares for each in found]),
        np.concatenate([each.gradient for each in found]),
        np.concatenate([each.information for each in found]),
    )
