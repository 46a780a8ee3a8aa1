# SPDX-License-Identifier: Apache-2.0
"""How a body that the inputs drive turns, and how a trailer behind it does: by time, and by way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from slipwise import _core
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Bools, Floats, Inputs, Poses

_STEP = 0.1  # [s] in which inputs are summed
_PARTS = 2  # of a step, in each of which a trailer follows
_WINDOW = 1.0  # [s] between the poses that are compared
_LONGEST = 2.5  # [s] beyond which they are not
_KNOWN = 0.9  # of a step, inputs must be known
_BACK = -1e-3  # m in a step; a trailer that is pushed folds
_SETTLED = 4.0  # [m] forwards after which a trailer follows again, wherever it was before
_LAGS = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6)  # [s] of a body that turns late
_DELAYS = (0.0, 0.2, 0.4, 0.8)  # [s]
_LAGS_OF_DRIVES = (0.0, 0.3)  # [s] of a robot that follows commands; one follows its wheels at once
_LONG = 900.0  # [s] of a run that are looked at
_FOLDED = 1.5  # [rad] a trailer folds no further
_LENGTHS = (0.4, 0.55, 0.75, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6)  # [m] from the hitch to the axle
_TURNS = (0.3, 0.45, 0.65, 0.9, 1.25)  # of the inputs' turns, by the robot that tows
_BEHIND = (0.0, 0.3)  # from the robot's axle to the hitch, in lengths
_TRAILERS = np.array(list(product(_LENGTHS, _TURNS, _BEHIND)))
_SCALE = (0.65, 1.5)  # of the turns that a trailer should make; farther off it is none
_KEPT = 0.9  # of the windows, by the size of what is left; the others may be jumps of poses


@dataclass(frozen=True, eq=False)
class Towing:
    """What the inputs of one run say in K steps, and how far the poses turn in N windows."""

    t: Floats  # [K + 1] s, edges of the steps
    forward: Floats  # [K] m
    rotation: Floats  # [K] rad
    start: Floats  # [N] s
    stop: Floats  # [N] s
    turn: Floats  # [N] rad, by the poses
    good: Bools  # [N] the robot drove forwards so far that a trailer follows

    @classmethod
    def of(cls, inputs: Inputs, poses: Poses, unknown_after: float) -> Towing | None:
        """Cut a run; None where inputs and poses share too little."""
        begin, end = max(poses.t[0], inputs.t[0]), min(poses.t[-1], inputs.t[-1])
        t = np.arange(begin, min(end, begin + _LONG), _STEP)
        if len(t) < 3:
            return None
        summed = [HeldSum.of(inputs, each, unknown_after) for each in (inputs.v, inputs.omega)]
        known = summed[0].known(t[:-1], t[1:]) > _KNOWN * _STEP
        forward, rotation = (np.where(known, each.between(t[:-1], t[1:]), 0.0) for each in summed)
        slot = np.floor((poses.t - poses.t[0]) / _WINDOW + 1e-6)
        kept = np.flatnonzero(np.diff(slot, prepend=-1.0) > 0.0)
        i, j = kept[:-1], kept[1:]
        near = (poses.frame[i] == poses.frame[j]) & (poses.t[j] - poses.t[i] < _LONGEST)
        near &= (poses.t[i] >= t[0]) & (poses.t[j] <= t[-1])
        i, j, yaw = i[near], j[near], np.unwrap(poses.yaw)
        way = np.cumsum(np.where(forward > 0.0, forward, 0.0))
        lost = (forward < _BACK) | ~known
        since = way - np.maximum.accumulate(np.where(lost, way, 0.0))
        follows = np.append(since, since[-1:]) > _SETTLED
        at = np.clip(np.searchsorted(t, poses.t[j]), 0, len(t) - 1)
        return cls(t, forward, rotation, poses.t[i], poses.t[j], yaw[j] - yaw[i], follows[at])

    def between(self, steps: Floats, delay: float = 0.0) -> Floats:
        """Sum what is in steps, [K, C], over the good windows, [G, C], `delay` s before."""
        total = np.vstack((np.zeros(steps.shape[1]), np.cumsum(steps, axis=0))).T
        start, stop = self.start[self.good] - delay, self.stop[self.good] - delay
        return np.column_stack([np.interp(stop, self.t, c) - np.interp(start, self.t, c) for c in total])


def turns(drives: Sequence[Towing]) -> Floats:
    """Return how far the poses turn [rad] in all good windows, [G]."""
    return np.concatenate([drive.turn[drive.good] for drive in drives])


def left_by_body(drives: Sequence[Towing]) -> float:
    """Return the part of the turns that is left by the best body whose turn depends on the inputs' past.

    It may turn late by a delay and a lag, by its speed, and pull to a side.
    """
    measured = turns(drives)
    return min(_left(columns, measured)[0] for columns in _bodies(drives))


def left_by_trailer(drives: Sequence[Towing], *, commanded: bool) -> tuple[float, float]:
    """Return the part of the turns that is left by the best trailer, and how long [m] that is.

    Args:
        drives: with at least one good window.
        commanded: the inputs are commands, which the robot that tows may follow late.
    """
    measured, best = turns(drives), (1.0, 0.0)
    for lag in _LAGS_OF_DRIVES if commanded else _LAGS_OF_DRIVES[:1]:
        towed = [
            _core.towed_turns(
                _lagged(each.forward, lag), _lagged(each.rotation, lag), _TRAILERS, _FOLDED, _PARTS
            )
            for each in drives
        ]
        pulls = np.concatenate([each.between(each.forward[:, None]) for each in drives])
        turned = np.concatenate([each.between(steps) for each, steps in zip(drives, towed, strict=True)])
        for number, column in enumerate(turned.T):
            left, scale = _left(np.column_stack((column, pulls)), measured)
            if left < best[0] and _SCALE[0] < scale < _SCALE[1]:
                best = (left, float(_TRAILERS[number, 0]))
    return best


def _bodies(drives: Sequence[Towing]) -> Iterator[Floats]:
    for lag in _LAGS:
        lagged = [(_lagged(each.forward, lag), _lagged(each.rotation, lag)) for each in drives]
        for delay in _DELAYS:
            yield np.concatenate(
                [
                    each.between(_ways_to_turn(*steps), delay)
                    for each, steps in zip(drives, lagged, strict=True)
                ]
            )


def _ways_to_turn(forward: Floats, rotation: Floats) -> Floats:
    """Return what the turn of a body may be a sum of, [K, 5]."""
    speed = np.abs(forward) / _STEP
    ways = (rotation, forward, rotation * speed, rotation * speed**2, rotation * np.abs(rotation))
    return np.column_stack(ways)


def _lagged(steps: Floats, lag: float) -> Floats:
    """Return steps [K] as a drive with a time constant of `lag` [s] follows them."""
    if lag == 0.0:
        return steps
    kernel = np.exp(-np.arange(0.0, 6.0 * lag, _STEP) / lag)
    return np.convolve(steps, kernel / kernel.sum())[: len(steps)]


def _left(columns: Floats, measured: Floats) -> tuple[float, float]:
    """Return which part of the squares a fit leaves, but for the largest, and the factor of the first."""
    factors = np.linalg.lstsq(columns, measured, rcond=None)[0]
    squares = np.sort((measured - columns @ factors) ** 2)[: int(np.ceil(_KEPT * len(measured)))]
    return float(squares.sum() / (measured @ measured)), float(factors[0])
