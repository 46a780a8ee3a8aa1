# SPDX-License-Identifier: Apache-2.0
"""Finds single speeds and yaw rates that no ground robot can have, from the samples before them alone."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Bools, Floats

NOMINAL = 20.0  # m/s or rad/s: what is slower is always accepted
FASTEST = 100.0  # m/s or rad/s: what is slower is accepted once it comes twice in a row
LEAP = 10.0  # anything is accepted up to this many times the fastest sample before it
_TWICE = 2.0  # a sample at most this many times the one before confirms it


def absurd_speeds(values: Floats) -> Bools:
    """Say which samples of a stream are absurd.

    A sample is absurd if faster than `NOMINAL`, more than `LEAP` times as fast as all that were accepted
    before it, and either faster than `FASTEST` or alone. So a spike of a few times what is usual stays, a
    log that starts at full speed loses its first sample, and no sample is judged by a later one.

    Args:
        values: one column of a stream [N] in m/s or rad/s, all finite, in order of time.
    """
    size = np.abs(values)
    absurd = np.zeros(len(values), bool)
    fast = np.flatnonzero(size > NOMINAL)
    if len(fast) == 0:
        return absurd
    slow = np.maximum.accumulate(np.where(size > NOMINAL, 0.0, size))  # the fastest that is always accepted
    fastest = 0.0  # of the others that were accepted
    for i in fast.tolist():
        near = size[i] <= max(NOMINAL, LEAP * max(float(slow[i]), fastest))
        confirmed = i > 0 and size[i] <= min(FASTEST, _TWICE * size[i - 1])
        if near or confirmed:
            fastest = max(fastest, float(size[i]))
        else:
            absurd[i] = True
    return absurd
