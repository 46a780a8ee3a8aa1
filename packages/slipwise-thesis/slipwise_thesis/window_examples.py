# SPDX-License-Identifier: Apache-2.0
"""Windows as examples of slip rates: the constant slip that takes the drive's path to the measured one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.prepared_run import WindowSet
from slipwise_thesis import _thesis
from slipwise_thesis.surfaces import SlipExamples

Floats = NDArray[np.float64]

_ONE_SEGMENT = _thesis.SlipRateSettings()  # with one pose to reach, any noise fits the same
_ONE_SEGMENT.noise = _thesis.SteadyNoise(np.ones(3), np.zeros(3), np.zeros(3))


def window_examples(
    reference: tuple[_core.MotionModel, Floats], windows: WindowSet, places: NDArray[np.int64]
) -> SlipExamples | None:
    """Return the slip rates of some windows, None where there is none.

    The drive of an example is the constant twist that leads where its window's drive leads. Its slip is that
    of the reference at this drive, plus what takes the reference's prediction to the measured pose, as a
    constant twist too. In a steady window the reference's slip cancels; in others it keeps curves out of the
    slip. Windows that turn by more than half a turn are left out: no such twist stands for them.

    Args:
        reference: a model and its parameters: slip, lag, delay, clock offset.
        windows: all windows.
        places: of those to turn into examples.
    """
    found = [row for row in (_row(reference, windows, i) for i in places.tolist()) if row is not None]
    if not found:
        return None
    rows = np.array(found)
    return SlipExamples(rows[:, 0].copy(), rows[:, 1].copy(), rows[:, 2:].copy())


def _row(reference: tuple[_core.MotionModel, Floats], windows: WindowSet, i: int) -> tuple[float, ...] | None:
    """V, omega and the three slip rates of window i."""
    model, mean = reference
    history, segment = windows.input_history(i), windows.segments[i]
    without_slip = np.concatenate((np.zeros(model.slip_size), mean[model.slip_size :]))
    paths = [
        _core.integrate_segment(model, parameters, history, segment, _core.Integrator.Exact)
        for parameters in (without_slip, mean)
    ]
    driven, predicted = (_core.Pose2(*np.array(path.poses[-1]).tolist()) for path in paths)
    moved = paths[1].robot_motion(segment.measured)
    if max(abs(pose.theta) for pose in (driven, predicted, moved)) > np.pi:
        return None
    time = segment.end - segment.start
    v, _, omega = (np.array(_core.log(driven)) / time).tolist()
    slip = _core.slip_rate(model.basis, mean[: model.slip_size], _core.SlipState(v, omega, 0.0, 0.0))
    twist = _core.BodyTwist(*(np.array(_core.log(predicted)) / time).tolist())
    poses = np.vstack((np.zeros(3), moved.vector()))
    steady = _thesis.SteadySegment(twist, np.array([0.0, time]), poses)
    missed = _thesis.fit_slip_rates([steady], _ONE_SEGMENT).slip
    return (v, omega, *(np.array(slip) + np.array(missed)).tolist())
