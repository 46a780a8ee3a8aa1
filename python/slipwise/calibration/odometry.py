# SPDX-License-Identifier: Apache-2.0
"""Where the robot is, how it moves, and whether it moves as it must, as a learner says it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Odometry:
    """Where the robot is and how it moves, in the conventions of nav_msgs/Odometry."""

    t: float  # s, stamp of the newest measurement
    pose: Floats  # [3] x, y [m], yaw [rad] in (-pi, pi], of base_link
    covariance: Floats  # [3, 3] of the pose, in the axes of the frame
    twist: Floats  # [3] v, vy [m/s], omega [rad/s] of base_link, slip included
    twist_covariance: Floats  # [3, 3]
    since_pose: float  # s since the last pose that was used was measured
    frame: int  # of that pose


@dataclass(frozen=True)
class MotionState:
    """How the robot moves beside what its inputs and the learned model say it must."""

    stuck: bool  # it does not move although it must
    fraction: float | None  # of the motion expected of the last 0.6 s; None where too little to tell
    since: float | None  # s, stamp at which it was first seen to be stuck; None where it is not


def odometry_of(found: _core.Odometry) -> Odometry:
    """Return what the core found, with the yaw wrapped."""
    return Odometry(
        t=found.t,
        pose=np.array([found.pose.x, found.pose.y, _core.wrap_angle(found.pose.theta)]),
        covariance=np.array(found.covariance),
        twist=np.array(found.twist),
        twist_covariance=np.array(found.twist_covariance),
        since_pose=found.since_pose,
        frame=found.frame,
    )
