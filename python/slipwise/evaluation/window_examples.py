# SPDX-License-Identifier: Apache-2.0
"""Windows as examples of slip rates: the constant slip that takes the drive's path to the measured one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.surfaces import SlipExamples

Floats = NDArray[np.float64]

_ONE_SEGMENT = _core.SlipRateSettings()  # with one pose to reach, any noise fits the same
_ONE_SEGMENT.noise = _core.SteadyNoise(np.ones(3), np.zeros(3), np.zeros(3))


def window_examples(
    drive: tuple[_core.MotionModel, Floats], windows: WindowSet, places: NDArray[np.int64]
) -> SlipExamples | None:
    """Return the slip rates of some windows, None where there is none.

    The drive of an example is the constant twist that leads where its window's drive leads. Windows that
    turn by more than half a turn are left out: no such twist stands for them.

    Args:
        drive: a model without slip, and its parameters: lag, delay, clock offset.
        windows: all windows.
        places: of those to turn into examples.
    """
    found = [row for row in (_row(drive, windows, i) for i in places.tolist()) if row is not None]
    if not found:
        return None
    rows = np.array(found)
    return SlipExamples(rows[:, 0].copy(), rows[:, 1].copy(), rows[:, 2:].copy())


def _row(drive: tuple[_core.MotionModel, Floats], windows: WindowSet, i: int) -> tuple[float, ...] | None:
    """V, omega and the three slip rates of window i."""
    model, chain = drive
    segment = windows.segments[i]
    path = _core.integrate_segment(model, chain, windows.track(i), segment, _core.Integrator.Exact)
    time = segment.end - segment.start
    driven = _core.Pose2(*np.array(path.poses[-1]).tolist())
    if max(abs(driven.theta), abs(segment.measured.theta)) > np.pi:
        return None
    twist = _core.BodyTwist(*(np.array(_core.log(driven)) / time).tolist())
    poses = np.vstack((np.zeros(3), segment.measured.vector()))
    steady = _core.SteadySegment(twist, np.array([0.0, time]), poses)
    slip = np.array(_core.fit_slip_rates([steady], _ONE_SEGMENT).slip)
    return (twist.v, twist.omega, *slip.tolist())
