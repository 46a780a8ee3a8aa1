# SPDX-License-Identifier: Apache-2.0
"""Finds headings that are a course over ground: they point to where the robot moves, in reverse too."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Bools, Log, Poses, Run
from slipwise.logs.motion_windows import MotionWindows
from slipwise.logs.navsat import course_of_path

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_LEAST = 0.03  # [m] by the inputs and by the poses; less tells no direction
_MOST_TURN = 1.5  # [rad] by the inputs and by the poses; on a tighter arc the ends tell little of the course
_ENOUGH = 3  # windows forwards, and as many backwards
_ALONG = 0.7  # mean cosine of the course to the heading from which on poses move along it
_GAP = 3.0  # [s] from a window to the next across a reversal
_REVERSALS = 2
_ABOUT = -0.3  # mean cosine of the turns across reversals; a drive that follows late does not turn about
SENTENCE = "the heading of the poses turns by half a turn when the robot reverses: it is a course over ground"


class CourseHeading(Check):
    """Headings that point to where the robot moves."""

    kind, family = "course-heading", "signs and units"
    means = "the heading is a course over ground, as of a satellite receiver"
    shows = "poses move along their heading in forward and reverse drive, and turn by half a turn in between"
    cure = "none: only positions are used; live `--set live.positions=true`, or a heading of two antennas"
    explained_by = ("does-not-move",)

    def look(self, seen: Seen) -> Finding | None:
        """Say whether poses move along their heading while the inputs drive forwards and backwards alike."""
        if seen.positions or not is_course(seen.windows, seen.sensor_yaw):
            return None
        advice = "Set [live] positions = true, to use positions only; slipwise calibrate does so by itself."
        return self.found(SENTENCE, advice)


def is_course(windows: MotionWindows, sensor_yaw: float = 0.0) -> bool:
    """Whether headings are a course over ground.

    Args:
        windows: of one kind of input.
        sensor_yaw: how the pose sensor is known to be turned on the robot [rad].
    """
    w = windows
    along = (w.distance > _LEAST) & (np.abs(w.forward) > _LEAST) & (np.abs(w.forward) > np.abs(w.sideways))
    along &= (np.abs(w.rotation) < _MOST_TURN) & (np.abs(w.turn) < _MOST_TURN)
    cosine = np.cos(w.course_ahead(sensor_yaw))

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
    advice = "Record a heading, of two antennas or a lidar, to learn a constant side slip too."
    found = CourseHeading.found(f"{SENTENCE}; only positions are used", advice, spoils=False)
    return replace(log, runs=runs).with_found(found)


def _positions(run: Run) -> Poses:
    poses, inputs = run.poses, run.wheels if run.wheels is not None else run.commands
    yaw = course_of_path(poses.t, poses.x, poses.y, inputs)
    return replace(poses, yaw=yaw, std_yaw=None, course=True)
