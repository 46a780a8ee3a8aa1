# SPDX-License-Identifier: Apache-2.0
"""Finds a pose sensor that sits off the centre of turning, or a robot that slips sideways as if it did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.driven_windows import MOST_TURN
from slipwise.logs.findings.finding import Check, Finding

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_ENOUGH = 20  # windows,
_TURNED = 2.0  # [rad^2] the sum of the squares of their turns
_FAR = 0.35  # [m] from the centre of turning; real robots slip as if it were 0.3 m
_CLEAR = 0.8  # correlation of sideways motion with turns


class SensorOffCentre(Check):
    """Poses that move sideways as the robot turns."""

    kind, family, spoils = "sensor-off-centre", "poses", False
    means = "the antenna or marker sits off the centre of turning, or the robot slips sideways as if it did"
    shows = "poses move sideways by 0.35 m and more for each radian of turn, with a correlation of 0.8"
    cure = "`--set sensor_extrinsics.x=...` with the numbers that are named"
    explained_by = ("does-not-move", "course-heading", "turned-poses", "backward-poses")

    def look(self, seen: Seen) -> Finding | None:
        """Fit the place of a sensor on a robot that turns about its origin."""
        w = seen.windows
        if seen.positions:
            return None
        near = np.abs(w.turn) < MOST_TURN
        turn, ahead = w.turn[near], w.course_ahead(seen.sensor_yaw)[near]
        (known_x, known_y, _), distance = seen.sensor, w.distance[near]
        along, across = distance * np.cos(ahead) + known_y * turn, distance * np.sin(ahead) - known_x * turn
        square = float(turn @ turn)
        if len(turn) < _ENOUGH or square < _TURNED:
            return None
        x = float(across @ turn) / square
        clear = float(across @ turn) / float(np.sqrt(square * (across @ across)) or 1.0)
        if abs(x) < _FAR or abs(clear) < _CLEAR:
            return None
        _, y = np.linalg.lstsq(np.column_stack((w.forward[near], -turn)), along, rcond=None)[0].tolist()
        x, y = x + known_x, y + known_y
        side, end = "left of" if y > 0.0 else "right of", "ahead of" if x > 0.0 else "behind"
        return self.found(
            f"the poses move sideways by {abs(x):.2f} m for each radian of turn: a sensor {abs(x):.2f} m "
            f"{end} and {abs(y):.2f} m {side} the centre of turning would, or a robot that slips so much",
            f"If it sits there, --set sensor_extrinsics.x={x:.2f} --set sensor_extrinsics.y={y:.2f} says so.",
            evidence=x,
        )
