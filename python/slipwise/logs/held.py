# SPDX-License-Identifier: Apache-2.0
"""Sums of held inputs over time, for comparing what a robot was commanded with where it went."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Floats, Inputs, Ints

UNKNOWN_AFTER = 0.5  # [s] an input is unknown once it is older than this, unless a setting says otherwise


def held_for(inputs: Inputs, unknown_after: float) -> Floats:
    """Return how long each input was held and known, [N] s; the last one for no time."""
    return np.minimum(np.diff(inputs.t, append=inputs.t[-1]), unknown_after)


def rests(inputs: Inputs, below: float, unknown_after: float) -> tuple[Ints, Ints]:
    """Return the places of the first and the last sample of each time in which all are below a size.

    Args:
        inputs: commands, or speeds of wheels.
        below: that size [m/s or rad/s].
        unknown_after: between samples that are further apart [s] a time ends.
    """
    still = np.abs(inputs.twists()).max(axis=1) < below
    same = still[1:] & still[:-1] & (np.diff(inputs.t) <= unknown_after)
    first = np.flatnonzero(still & np.concatenate(([True], ~same)))
    return first, np.flatnonzero(still & np.concatenate((~same, [True])))


@dataclass(frozen=True, eq=False)
class HeldSum:
    """The integral over time of a held quantity, and of the time for which it is known."""

    _t: Floats  # [K] knots
    _sum: NDArray[Any]  # [K], complex where two are summed together
    _known: Floats  # [K] s

    @classmethod
    def of(cls, inputs: Inputs, values: NDArray[Any], unknown_after: float) -> HeldSum:
        """Integrate `values` [N], held from each stamp to the next, at most for `unknown_after` [s]."""
        hold = np.minimum(np.diff(inputs.t, append=np.inf), unknown_after)
        knots = np.stack([inputs.t, inputs.t + hold], axis=1).ravel()
        total, known = np.cumsum(values * hold), np.cumsum(hold)
        return cls(knots, _steps(total), _steps(known))

    def between(self, start: Floats, stop: Floats) -> NDArray[Any]:
        """Return the integral from start [M] to stop [M]."""
        return _risen(start, stop, self._t, self._sum)

    def known(self, start: Floats, stop: Floats) -> Floats:
        """Return the time between start [M] and stop [M] for which there is an input, in s."""
        return _risen(start, stop, self._t, self._known)


def _risen(start: Floats, stop: Floats, t: Floats, total: NDArray[Any]) -> NDArray[Any]:
    """Return by how much a sum rises between times; those that follow each other are looked up once."""
    if len(start) > 1 and np.array_equal(start[1:], stop[:-1]):
        return np.diff(np.interp(np.append(start, stop[-1]), t, total))
    return np.asarray(np.interp(stop, t, total) - np.interp(start, t, total))


def _steps(total: NDArray[Any]) -> NDArray[Any]:
    before = np.concatenate([[0.0], total[:-1]])
    return np.stack([before, total], axis=1).ravel()
