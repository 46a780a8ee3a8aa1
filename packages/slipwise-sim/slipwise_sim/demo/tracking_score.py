# SPDX-License-Identifier: Apache-2.0
"""How well a drive kept to its path: cross-track error over all of it, and after changes of floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise_sim.demo.closed_loop import Driven
from slipwise_sim.demo.slalom_drive import Trace

Floats = NDArray[np.float64]

SETTLED = 10.0  # [s] of driving after a change, within which a learner should have recovered
RECOVERED = 1.1  # times the error of a model of the floor
SMOOTHED = 5.0  # [s] over which the error is averaged to see whether a robot has recovered


@dataclass(frozen=True)
class Tracking:
    """The scores of one drive. Errors are means over time of the distance to the path."""

    mean: float  # m
    rms: float  # m
    worst: float  # m
    seconds: float  # s until the end of the course, or until it was given up
    arrived: bool
    settled: tuple[
        float, ...
    ]  # m, on each floor from `SETTLED` after its beginning on; NaN where never there
    recovery: tuple[float, ...]  # s after each change; infinite where the next floor or the end came first


def tracking(driven: Driven, each_floor: Driven) -> Tracking:
    """Score a drive; `each_floor` is the drive with a model for each floor, on the same course."""
    trace = driven.trace
    error = np.abs(trace.left)
    floors = range(int(each_floor.trace.floor.max()) + 1)
    wanted = [RECOVERED * settled_error(each_floor.trace, floor) for floor in floors]
    return Tracking(
        mean=float(error.mean()),
        rms=float(np.sqrt(np.square(error).mean())),
        worst=float(error.max()),
        seconds=float(trace.t[-1]),
        arrived=driven.arrived,
        settled=tuple(settled_error(trace, floor) for floor in floors),
        recovery=tuple(recovery_time(trace, floor, wanted[floor]) for floor in floors[1:]),
    )


def settled_error(trace: Trace, floor: int) -> float:
    """Return the mean error [m] on a floor from `SETTLED` after its beginning on; NaN where that never is."""
    t, error = _on_floor(trace, floor)
    late = error[t >= SETTLED]
    return float(late.mean()) if len(late) else math.nan


def recovery_time(trace: Trace, floor: int, wanted: float) -> float:
    """Return after how long [s] on a floor the error has come down to `wanted` [m]; infinite where never.

    The error is the mean over `SMOOTHED` seconds; the time is that of their beginning.
    """
    t, error = _on_floor(trace, floor)
    if not len(t):
        return math.inf
    reached = np.searchsorted(t, t + SMOOTHED - 1e-9)  # where the seconds from t on end
    total = np.concatenate(([0.0], np.cumsum(error)))
    whole = np.flatnonzero(reached < len(t))
    means = (total[reached[whole]] - total[whole]) / (reached[whole] - whole)
    down = np.flatnonzero(means <= wanted)
    return float(t[whole[down[0]]]) if len(down) else math.inf


def _on_floor(trace: Trace, floor: int) -> tuple[Floats, Floats]:
    """Return times since the beginning of a floor [s], and the errors [m] there."""
    there = trace.floor == floor
    t = trace.t[there]
    return (t - t[0] if len(t) else t), np.abs(trace.left[there])
