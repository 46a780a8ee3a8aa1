# SPDX-License-Identifier: Apache-2.0
"""Finds headings that are a course over ground: they point to where the robot moves, in reverse too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.logs.contradiction import Contradiction
from slipwise.logs.log import Bools, Log, Poses, Run
from slipwise.logs.motion_windows import MotionWindows, wrapped
from slipwise.logs.navsat import course_of_path

_LEAST = 0.03  # [m] by the inputs and by the poses; less tells no direction
_MOST_TURN = 1.5  # [rad] by the inputs and by the poses; on a tighter arc the ends tell little of the course
_ENOUGH = 3  # windows forwards, and as many backwards
_ALONG = 0.7  # mean cosine of the course to the heading from which on poses move along it
_GAP = 3.0  # [s] from a window to the next across a reversal
_REVERSALS = 2
_ABOUT = -0.3  # mean cosine of the turns across reversals; a drive that follows late does not turn about
SENTENCE = "the heading of the poses turns by half a turn when the robot reverses: it is a course over ground"


def course_heading(windows: MotionWindows, sensor_yaw: float = 0.0) -> Contradiction | None:
    """Say whether poses move along their heading while the inputs drive forwards and backwards alike.

    Args:
        windows: of one kind of input.
        sensor_yaw: how the pose sensor is known to be turned on the robot [rad].
    """
    if not is_course(windows, sensor_yaw):
        return None
    advice = "Set [live] positions = true, to use positions only; slipwise calibrate does so by itself."
    return Contradiction("course-heading", SENTENCE, (advice,))


def is_course(windows: MotionWindows, sensor_yaw: float = 0.0) -> bool:
    """Whether headings are a course over ground; arguments as of `course_heading`."""
    w = windows
    along = (w.distance > _LEAST) & (np.abs(w.forward) > _LEAST) & (np.abs(w.forward) > np.abs(w.sideways))
    along &= (np.abs(w.rotation) < _MOST_TURN) & (np.abs(w.turn) < _MOST_TURN)
    cosine = np.cos(wrapped(w.course - w.start_yaw - 0.5 * w.turn + sensor_yaw))

    def moves_along(chosen: Bools) -> bool:
        return int(chosen.sum()) >= _ENOUGH and float(cosine[chosen].mean()) > _ALONG

    if not (moves_along(along & (w.forward > 0.0)) and moves_along(along & (w.forward < 0.0))):
        return False
    k = np.flatnonzero(along)
    before, after = k[:-1], k[1:]
    gap = w.start[after] - w.start[before] - w.duration[before]
    reverses = (w.run[before] == w.run[after]) & (w.forward[before] * w.forward[after] < 0.0) & (gap < _GAP)
    turned = (w.start_yaw[after] - w.start_yaw[before] - w.turn[before])[reverses]
    return len(turned) >= _REVERSALS and float(np.cos(turned).mean()) < _ABOUT


def as_positions(log: Log) -> Log:
    """Return the log with positions alone, since its headings are a course over ground; which is noted."""
    runs = tuple(replace(run, poses=_positions(run)) for run in log.runs)
    return replace(log, runs=runs, notes=(*log.notes, f"{SENTENCE}; only positions are used"))


def _positions(run: Run) -> Poses:
    poses, inputs = run.poses, run.wheels if run.wheels is not None else run.commands
    yaw = course_of_path(poses.t, poses.x, poses.y, inputs)
    return replace(poses, yaw=yaw, std_yaw=None, course=True)
