# SPDX-License-Identifier: Apache-2.0
"""The twist of an odometry; differences of its poses where the twist stays zero though they move."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipwise.logs.log import Bools, Floats
from slipwise.logs.motion_windows import wrapped

_MOVES = (0.05, 0.05)  # [m], [rad] that the poses must change by before a twist of zero is rejected


def twist_and_pose(message: Any) -> tuple[float, ...]:
    """(v, vy, omega, x, y, yaw) of a nav_msgs/Odometry."""
    twist, pose = message.twist.twist, message.pose.pose
    q, p = pose.orientation, pose.position
    yaw = math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))
    return (twist.linear.x, twist.linear.y, twist.angular.z, p.x, p.y, yaw)


def poses_move(poses: Floats) -> bool:
    """Say whether poses (x, y, yaw) [N, 3] leave the first one."""
    known = poses[np.isfinite(poses).all(axis=1)]
    if len(known) < 2:
        return False
    far = np.abs(known - known[0])
    return bool(
        (far[:, :2] > _MOVES[0]).any() or (np.abs(wrapped(known[:, 2] - known[0, 2])) > _MOVES[1]).any()
    )


def always_zero(twists: Floats) -> bool:
    """Say whether twists [N, 3] never say that anything moves."""
    return not (np.isfinite(twists) & (twists != 0.0)).any()


def twists_between(t: Floats, poses: Floats) -> Floats:
    """Return the body twists [N, 3] that take each pose (x, y, yaw) [N, 3] to the next one.

    Each is held from its stamp on; the last sample keeps the twist before it. NaN where stamps [N] do not go
    forward.
    """
    steps = np.diff(t)
    forward: Bools = steps > 0.0
    turn = wrapped(np.diff(poses[:, 2]))
    middle = poses[:-1, 2] + 0.5 * turn
    dx, dy = np.diff(poses[:, 0]), np.diff(poses[:, 1])
    along, across = np.cos(middle) * dx + np.sin(middle) * dy, np.cos(middle) * dy - np.sin(middle) * dx
    twists = np.full((len(t), 3), np.nan)
    twists[:-1][forward] = np.column_stack((along, across, turn))[forward] / steps[forward, None]
    twists[-1:] = twists[-2:-1]
    return twists
