# SPDX-License-Identifier: Apache-2.0
"""Finding the stretches of a run in which the command was held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class HoldRules:
    """When commands count as the same. A held speed and yaw rate are a held speed and curvature."""

    speed: float = 0.01  # m/s; a command within this of the hold's first one continues it
    yaw_rate: float = 0.01  # rad/s
    unknown_after: float = UNKNOWN_AFTER  # s; a command is unknown once it is older than this
    still_speed: float = 0.02  # m/s and rad/s; a hold at or below both is the robot standing still


@dataclass(frozen=True)
class Hold:
    """A stretch of one command; the median of its samples."""

    start: float  # s
    end: float  # s
    v: float  # m/s
    vy: float  # m/s
    omega: float  # rad/s


def find_holds(inputs: Inputs, rules: HoldRules = HoldRules()) -> tuple[Hold, ...]:
    """Return the holds of one run in order of time, without those in which the robot was commanded to stand.

    A hold ends where the command changes or is unknown, and at the last sample.
    """
    count = len(inputs)
    if count == 0:
        return ()
    gap = np.diff(inputs.t) > rules.unknown_after
    holds = []
    first = 0
    for i in range(1, count + 1):
        if i < count and not gap[i - 1] and _same(inputs, first, i, rules):
            continue
        holds.append(_hold(inputs, first, i, rules))
        first = i
    still = rules.still_speed
    moving = (h for h in holds if max(abs(h.v), abs(h.vy), abs(h.omega)) > still and h.end > h.start)
    return tuple(moving)


def _same(inputs: Inputs, i: int, j: int, rules: HoldRules) -> bool:
    speed = max(abs(float(inputs.v[j] - inputs.v[i])), abs(float(inputs.vy[j] - inputs.vy[i])))
    return speed <= rules.speed and abs(float(inputs.omega[j] - inputs.omega[i])) <= rules.yaw_rate


def _hold(inputs: Inputs, first: int, after: int, rules: HoldRules) -> Hold:
    """The hold of the samples first..after-1; it lasts until the next sample, or until it is unknown."""
    last = float(inputs.t[after - 1])
    end = min(float(inputs.t[after]), last + rules.unknown_after) if after < len(inputs) else last
    part = slice(first, after)
    middle = (float(np.median(column[part])) for column in (inputs.v, inputs.vy, inputs.omega))
    return Hold(float(inputs.t[first]), end, *middle)
