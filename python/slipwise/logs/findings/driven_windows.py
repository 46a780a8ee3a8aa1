# SPDX-License-Identifier: Apache-2.0
"""The windows in which the inputs drive the robot along a line, and how far and where to its poses went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Floats
from slipwise.logs.motion_windows import MotionWindows, wrapped

_LEAST = 0.05  # [m] by the inputs; less tells no direction
_PART = 0.3  # of the fast windows' distance by the inputs; slower windows are left to the others
MOST_TURN = 1.5  # [rad] by the inputs and by the poses; on a tighter arc the ends tell little of the course
_MOVED = 0.01  # [m] poses that moved less have no course


@dataclass(frozen=True, eq=False)
class DrivenWindows:
    """Poses against inputs in N windows, in order of time within each run."""

    run: Floats  # [N] number of the run
    start: Floats  # [N] s
    forward: Floats  # [N] m, by the inputs
    scale: Floats  # [N] distance of the poses over that of the inputs
    course: NDArray[np.complex128]  # [N] where to the poses went, seen from where the inputs say; 0: nowhere

    def __len__(self) -> int:
        return len(self.run)

    @property
    def direction(self) -> complex:
        """The mean course: of length 1 where all windows agree, of angle 0 where poses follow the inputs."""
        return complex(self.course.mean()) if len(self) else 0j


def driven_windows(windows: MotionWindows, sensor_yaw: float = 0.0) -> DrivenWindows:
    """Pick the windows in which the inputs say that the robot is driven along a line or a wide arc.

    Args:
        windows: of one kind of input.
        sensor_yaw: how the pose sensor is known to be turned on the robot [rad].
    """
    w = windows
    driven = np.hypot(w.forward, w.sideways)
    fast = float(np.quantile(driven, 0.9)) if len(w) else 0.0
    along = (driven > max(_LEAST, _PART * fast)) & (np.abs(w.rotation) < MOST_TURN)
    along &= np.abs(w.turn) < MOST_TURN
    heading = w.start_yaw + 0.5 * w.turn - sensor_yaw + np.arctan2(w.sideways, w.forward)
    course = np.where(w.distance > _MOVED, np.exp(1j * wrapped(w.course - heading)), 0.0)
    return DrivenWindows(
        run=w.run[along],
        start=w.start[along],
        forward=w.forward[along],
        scale=(w.distance / np.maximum(driven, _LEAST))[along],
        course=course[along],
    )
