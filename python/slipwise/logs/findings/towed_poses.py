# SPDX-License-Identifier: Apache-2.0
"""Finds poses of a trailer: their heading follows the robot's by way, not by time."""

from __future__ import annotations

from slipwise.logs.findings.driven_steps import driven_steps, left_by_body, turns, ways_to_turn
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.pose_streams import told_by
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.findings.towing import after_a_way, left_by_trailer
from slipwise.logs.log import has_course

_ENOUGH = 30  # windows of 1 s in which a trailer would follow,
_TURNED = 1.0  # [rad^2] the sum of the squares of their turns
_UNEXPLAINED = 0.004  # of that by any body; where less is left, it is one
_FEW = 0.05  # of that by a trailer,
_TIMES = 5.0  # and so many times as much by any body; real robots leave twice as much at most


class TowedPoses(Check):
    """Headings that turn as those of a trailer behind the robot do."""

    kind, family = "towed-poses", "poses"
    hidden_by = ("two-sources", "course-heading", "unrelated", "implausible", "lost-sign")
    means = "the pose sensor is on a trailer, or its heading is a course over the last metres of the way"
    shows = "a trailer leaves 5 % of the turns at most, and a body that turns late in time 5 times as much"
    cure = "put the sensor on the robot; where the heading is a course, leave `yaw` out: positions are used"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare turns of the poses with those of bodies and of trailers that the inputs drive."""
        name = told_by(whole)
        if has_course(whole.log.runs):
            return None
        cut = [after_a_way(steps) for steps in driven_steps(whole, name)]
        drives = [each for each in cut if each.chosen.any()]
        if sum(int(each.chosen.sum()) for each in drives) < _ENOUGH:
            return None
        measured = turns(drives)
        turned = float(measured @ measured)
        if turned < _TURNED:
            return None
        body = left_by_body(drives, measured, ways_to_turn)
        if body < _UNEXPLAINED * turned:
            return None
        trailer, length = left_by_trailer(drives, commanded=name == "command")
        if trailer > _FEW * turned or body < _TIMES * trailer:
            return None
        return self.found(
            f"the poses turn as a trailer does that the robot tows about {length:.1f} m behind it: the best "
            f"of bodies that turn late leaves {body / trailer:.0f} times as much of their turns unexplained",
            "Give poses of a sensor on the robot itself.",
            "Where the heading is a course over the last metres, leave it out: positions alone are used.",
            evidence=length,
        )
