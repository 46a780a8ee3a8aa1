# SPDX-License-Identifier: Apache-2.0
"""Finds single speeds and yaw rates that no ground robot can have, from the samples before them alone."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Bools, Floats

NOMINAL = 20.0  # m/s or rad/s: a command, or the first sample, that is slower is always accepted
STEP = 5.0  # m/s or rad/s: wheels that are measured, and slower, are always accepted
FASTEST = 100.0  # m/s or rad/s: what is slower is accepted once it comes twice in a row
LEAP = 15.0  # anything is accepted up to this many times the fastest sample before it
_TWICE = 2.0  # a sample at most this many times the one before confirms it


def absurd_speeds(values: Floats, *, measured: bool = False) -> Bools:
    """Say which samples of a stream are absurd.

    A sample is absurd if faster than `NOMINAL`, more than `LEAP` times as fast as all that were accepted
    before it, and either faster than `FASTEST` or alone. Wheels do not step as commands may: for them `STEP`
    stands in the place of `NOMINAL`, after the first sample. So a spike of a few times what is usual stays, a
    log that starts at full speed loses its first sample, and no sample is judged by a later one.

    Args:
        values: one column of a stream [N] in m/s or rad/s, all finite, in order of time.
        measured: these are speeds of wheels, not commands.
    """
    size = np.abs(values)
    absurd = np.zeros(len(values), bool)
    usual = STEP if measured else NOMINAL
    fast = np.flatnonzero(size > usual)
    if len(fast) == 0:
        return absurd
    slow = np.maximum.accumulate(np.where(size > usual, 0.0, size))  # the fastest that is always accepted
    believed = int(np.argmax(size <= usual)) if len(fast) < len(size) else len(size)  # the first accepted
    fastest = 0.0  # of the others that were accepted
    for i in fast.tolist():
        near = size[i] <= (NOMINAL if i < believed else max(usual, LEAP * max(float(slow[i]), fastest)))
        confirmed = i > 0 and size[i] <= min(FASTEST, _TWICE * size[i - 1])
        if not (near or confirmed):
            absurd[i] = True
            continue
        if confirmed or i > believed:  # nothing stands for the very first
            fastest = max(fastest, float(size[i]))
        believed = min(believed, i)
    return absurd
