# SPDX-License-Identifier: Apache-2.0
"""Keeps the samples whose stamps go forward."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.log import Bools, Floats

BACKWARD, GOES_BACK = "backward-stamp", "whose stamp goes backward"  # kind and words of what is left out
LATEST = float(2**32)  # s; what is later, in the year 2106, is no time in seconds
_UNITS = ((1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds"))
_SPIKE_FACTOR = 10.0  # a stamp this many usual steps ahead, taken back by the next one, is a fault of its own


def forward_stamps(t: Floats) -> tuple[Bools, Bools, Bools]:
    """Sort the samples of a stream by what their stamps do.

    A lone stamp far in the future would turn everything after it into the past, so such a spike, at the start
    too, is taken out first; of the rest a sample is kept if it is later than all samples before it, by more
    than rounding.

    Args:
        t: stamps [N] in s, all finite, as they came.

    Returns:
        (keep, duplicate, backward), each [N]; every sample is in exactly one of them.
    """
    step = np.diff(t)
    if (step > _core.SAME_STAMP).all():
        none = np.zeros(len(t), bool)
        return ~none, none, none.copy()
    spike = lone_spikes(t)
    steady = np.where(spike, -np.inf, t)
    latest = np.concatenate([[-np.inf], np.maximum.accumulate(steady)[:-1]])
    keep = ~spike & (t > latest + _core.SAME_STAMP)
    duplicate = ~spike & ~keep & (t >= latest - _core.SAME_STAMP)
    return keep, duplicate, ~keep & ~duplicate


def unit_advice(stamp: float) -> str:
    """Say what to do about a stamp that is no time in seconds; names the unit in which it is one."""
    for factor, unit in _UNITS:
        if stamp * factor < LATEST:
            return f"stamps must be in seconds; these look like {unit}, so divide them by {1.0 / factor:.0e}"
    return "stamps must be in seconds; these are no time in any unit, so record or convert the log again"


def lone_spikes(t: Floats) -> Bools:
    """Say which stamps [N], finite and as they came, are far ahead and taken back by the next one."""
    step = np.diff(t)
    usual = np.median(np.abs(step[step != 0.0])) if (step != 0.0).any() else 0.0
    spike = np.zeros(len(t), bool)
    if len(t) > 2:
        ahead = (step[:-1] > _SPIKE_FACTOR * usual) & (step[1:] < 0.0) & (t[2:] > t[:-2])
        spike[1:-1] = ahead
        spike[0] = t[0] > max(t[1], t[2]) and t[2] > t[1] and -step[0] > _SPIKE_FACTOR * usual
    return spike
