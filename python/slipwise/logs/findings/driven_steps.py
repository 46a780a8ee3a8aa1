# SPDX-License-Identifier: Apache-2.0
"""What inputs say in short steps, how far poses move in windows, and how these follow the inputs in time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.findings.pose_streams import inputs_of
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Bools, Floats, Inputs, Poses

Numbers = NDArray[Any]  # real, or complex: in the plane

STEP = 0.1  # [s] in which inputs are summed
_WINDOW = 1.0  # [s] between the poses that are compared
_LONGEST = 2.5  # [s] beyond which they are not
_KNOWN = 0.9  # of a step, inputs must be known
_LONG = 900.0  # [s] of a run that are looked at
_KEPT = 0.9  # of the windows, by the size of what is left; the others may be jumps of poses,
_JUMP = 15.0  # times the usual size of what is left, which bend no fit
_LAGS = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6)  # [s] of a body that follows late
_DELAYS = (-0.4, -0.2, 0.0, 0.2, 0.4, 0.8)  # [s]


@dataclass(frozen=True, eq=False)
class DrivenSteps:
    """What the inputs of one run say in K steps, and how far the poses move in N windows."""

    t: Floats  # [K + 1] s, edges of the steps
    forward: Floats  # [K] m
    sideways: Floats  # [K] m
    rotation: Floats  # [K] rad
    known: Bools  # [K] the inputs were
    heading: Floats  # [K] rad, of the poses amid each step
    start: Floats  # [N] s
    stop: Floats  # [N] s
    turn: Floats  # [N] rad, by the poses
    way: NDArray[np.complex128]  # [N] m, by the poses, in their frame: x + iy
    swing: NDArray[np.complex128]  # [N] of what is 1 m ahead of them
    chosen: Bools  # [N] windows that are compared; at first those whose inputs were known

    @classmethod
    def of(cls, inputs: Inputs, poses: Poses, unknown_after: float) -> DrivenSteps | None:
        """Cut a run; None where inputs and poses share too little."""
        begin, end = max(poses.t[0], inputs.t[0]), min(poses.t[-1], inputs.t[-1])
        t = np.arange(begin, min(end, begin + _LONG), STEP)
        if len(t) < 3:
            return None
        summed = [HeldSum.of(inputs, each, unknown_after) for each in (inputs.v, inputs.vy, inputs.omega)]
        known = summed[0].known(t[:-1], t[1:]) > _KNOWN * STEP
        forward, sideways, rotation = (np.where(known, each.between(t[:-1], t[1:]), 0.0) for each in summed)
        slot = np.floor((poses.t - poses.t[0]) / _WINDOW + 1e-6)
        kept = np.flatnonzero(np.diff(slot, prepend=-1.0) > 0.0)
        i, j = kept[:-1], kept[1:]
        near = (poses.frame[i] == poses.frame[j]) & (poses.t[j] - poses.t[i] < _LONGEST)
        near &= (poses.t[i] >= t[0]) & (poses.t[j] <= t[-1])
        i, j, yaw, place = i[near], j[near], np.unwrap(poses.yaw), poses.x + 1j * poses.y
        ahead = np.exp(1j * yaw)
        unknown = np.append(0, np.cumsum(~known))
        first = np.searchsorted(t, poses.t[i], side="right") - 1
        last = np.minimum(np.searchsorted(t, poses.t[j]), len(known))
        return cls(
            t=t,
            forward=forward,
            sideways=sideways,
            rotation=rotation,
            known=known,
            heading=np.interp(t[:-1] + 0.5 * STEP, poses.t, yaw),
            start=poses.t[i],
            stop=poses.t[j],
            turn=yaw[j] - yaw[i],
            way=place[j] - place[i],
            swing=ahead[j] - ahead[i],
            chosen=unknown[last] == unknown[first],
        )

    @property
    def path(self) -> NDArray[np.complex128]:
        """The steps of the inputs along the poses' headings, [K] m."""
        return np.asarray((self.forward + 1j * self.sideways) * np.exp(1j * self.heading))

    def between(self, steps: Iterable[Numbers], delay: float = 0.0) -> Numbers:
        """Sum what is in steps, C of [K], over the chosen windows, [G, C], `delay` s before."""
        start, stop = self.start[self.chosen] - delay, self.stop[self.chosen] - delay
        totals = [np.append(0.0, np.cumsum(each)) for each in steps]
        return np.column_stack([np.interp(stop, self.t, s) - np.interp(start, self.t, s) for s in totals])


def lagged(steps: Numbers, lag: float) -> Numbers:
    """Return steps [K] as what follows them with a time constant of `lag` [s] makes them."""
    if lag == 0.0:
        return steps
    kernel = np.exp(-np.arange(0.0, 6.0 * lag, STEP) / lag)
    return np.convolve(steps, kernel / kernel.sum())[: len(steps)]


def driven_steps(whole: WholeLog, name: str) -> list[DrivenSteps]:
    """Cut all runs of a log that share enough with their inputs of this kind, "command" or "wheel"."""
    pairs = [(inputs_of(run, name), run.poses.as_measured) for run in whole.log.runs]
    cut = [DrivenSteps.of(i, p, whole.unknown_after) for i, p in pairs if i is not None and len(p) > 1]
    return [each for each in cut if each is not None]


def fit(columns: Numbers, measured: Numbers) -> tuple[float, Numbers]:
    """Fit the sum of columns [G, C] that is nearest to what was measured, [G], jumps left out.

    Returns:
        the sum of the squares that is left, but for the largest, and the factors [C].
    """
    factors = np.linalg.lstsq(columns, measured, rcond=None)[0]
    left = np.abs(measured - columns @ factors)
    steady = left < _JUMP * np.median(left)
    if steady.any() and not steady.all():
        factors = np.linalg.lstsq(columns[steady], measured[steady], rcond=None)[0]
    squares = np.sort(np.abs(measured - columns @ factors) ** 2)[: int(np.ceil(_KEPT * len(measured)))]
    return float(squares.sum()), factors


def turns(drives: Sequence[DrivenSteps]) -> Floats:
    """Return how far the poses turn [rad] in the chosen windows of all runs, [G]."""
    return np.concatenate([drive.turn[drive.chosen] for drive in drives])


def left_by_body(
    drives: Sequence[DrivenSteps],
    measured: Numbers,
    ways: Callable[[DrivenSteps, float], Sequence[Numbers]],
    *also: Numbers,
) -> float:
    """Return the sum of the squares of what was measured, [G], that is left by the best body that is late.

    Args:
        drives: the runs, with at least one chosen window.
        measured: in their chosen windows.
        ways: what the motion of a body with some lag [s] may be a sum of, each [K], in the steps of a run.
        also: what it may be a sum of besides, each [G].
    """
    found = []
    for lag in _LAGS:
        steps = [ways(each, lag) for each in drives]
        for delay in _DELAYS:
            rows = [each.between(of_run, delay) for each, of_run in zip(drives, steps, strict=True)]
            found.append(fit(np.column_stack((np.concatenate(rows), *also)), measured)[0])
    return min(found)


def ways_to_turn(drive: DrivenSteps, lag: float) -> Sequence[Floats]:
    """Return what the turns of a body with a lag [s] may be a sum of: also by speed, and a pull to a side."""
    forward, rotation = lagged(drive.forward, lag), lagged(drive.rotation, lag)
    speed = np.abs(forward) / STEP
    return rotation, forward, rotation * speed, rotation * speed**2, rotation * np.abs(rotation)
