# SPDX-License-Identifier: Apache-2.0
"""Sums of held inputs over time, for comparing what a robot was commanded with where it went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    _sum: Floats  # [K]
    _known: Floats  # [K] s

    @classmethod
    def of(cls, inputs: Inputs, values: Floats, unknown_after: float) -> HeldSum:
        """Integrate `values` [N], held from each stamp to the next, at most for `unknown_after` [s]."""
        hold = np.minimum(np.diff(inputs.t, append=np.inf), unknown_after)
        knots = np.stack([inputs.t, inputs.t + hold], axis=1).ravel()
        total, known = np.cumsum(values * hold), np.cumsum(hold)
        return cls(knots, _steps(total), _steps(known))

    def between(self, start: Floats, stop: Floats) -> Floats:
        """Return the integral from start [M] to stop [M]."""
        return np.asarray(np.interp(stop, self._t, self._sum) - np.interp(start, self._t, self._sum))

    def known(self, start: Floats, stop: Floats) -> Floats:
        """Return the time between start [M] and stop [M] for which there is an input, in s."""
        return np.asarray(np.interp(stop, self._t, self._known) - np.interp(start, self._t, self._known))


def _steps(total: Floats) -> Floats:
    before = np.concatenate([[0.0], total[:-1]])
    return np.stack([before, total], axis=1).ravel()
