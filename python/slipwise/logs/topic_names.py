# SPDX-License-Identifier: Apache-2.0
"""What the names of topics say about what they hold, and how well that fits a role."""

from __future__ import annotations

import re
from collections.abc import Sequence

from slipwise.logs.messages import ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE, TWIST_STAMPED

Names = Sequence[tuple[str, int, str]]

MEASURED_OUTSIDE = 80  # from this score on a pose comes from a sensor of its own: cameras, RTK, ground truth

_BEST = r"ground_?truth|gazebo|model_pose"
_CAMERAS = r"mocap|vicon|vrpn|optitrack|qualisys|natnet"
_SCANS = r"lidar|slam|localization|amcl|visual|(^|[/_])(lio|loam|particle|pf|zed|vio)"
SATELLITES = r"gps|gnss|navsat|(^|[/_])(fix|ins)($|[/_])"
_DRIVE = r"velocity_controller|diff_drive|base_controller|drive_controller"
FUSED = r"filtered|fused|(^|[/_])(ekf|ukf)"
WHEEL_ODOMETRY = rf"wheel|encoder|{_DRIVE}|odom"

_NO_COMMAND = "its name says that it is measured, not commanded"
_NO_POSE = "its name says that it is wheel odometry, which cannot show its own slip"
_GOAL = "its name says that it is a goal or a plan"
_NO_WHEELS = "its name says that it is not wheel odometry"

# (pattern, score, why not): the first pattern found in the lower-case name counts; below 0 it is excluded.
COMMAND_NAMES: Names = (
    (r"odom|measured|feedback|vrpn|mocap|gps|imu|wheel_vel|estimate|ground_truth|state", -1, _NO_COMMAND),
    (r"cmd_vel_out$", 6, ""),
    (r"(^|/)cmd_vel$", 5, ""),
    (r"cmd_vel_(unstamped|stamped)$", 4, ""),
    (r"cmd_vel", 3, ""),
    (r"(^|[/_])(cmd|command|drive|ackermann\w*)($|[/_])", 2, ""),
)
POSE_NAMES: Names = (
    (r"goal|target|plan|setpoint|initialpose|command|cmd|waypoint", -1, _GOAL),
    (_BEST, 10, ""),
    (_CAMERAS, 9, ""),
    (r"rtk", 8, ""),
    (r"icp", 7, ""),
    (_SCANS, 6, ""),
    (SATELLITES, 5, ""),
    (rf"wheel|encoder|{_DRIVE}", -1, _NO_POSE),
    (r"odom.*global|global.*odom", 4, ""),
    (FUSED, 2, ""),
    (r"odom", -1, _NO_POSE),
)
WHEEL_NAMES: Names = (
    (rf"{_BEST}|{_CAMERAS}|rtk|icp|{_SCANS}|{SATELLITES}", -1, _NO_WHEELS),
    (r"wheel|encoder", 6, ""),
    (_DRIVE, 5, ""),
    (rf"{FUSED}|local|global", -1, _NO_WHEELS),
    (r"odom", 4, ""),
    (r"joint_states?$", 2, ""),
)
_TYPE_SCORE = {TWIST_STAMPED: 1, POSE_STAMPED: 1, ODOMETRY: 2, POSE_WITH_COVARIANCE: 3}


def score_of(name: str, kind: str, names: Names) -> tuple[int, str]:
    """Return 10 times the name's score, a little more for types that say more; below 0 with the reason."""
    for pattern, score, why in names:
        if re.search(pattern, name.lower()):
            return (10 * score + _TYPE_SCORE.get(kind, 0), "") if score >= 0 else (-1, why)
    return _TYPE_SCORE.get(kind, 0), ""


def looks_like(name: str, pattern: str) -> bool:
    """Say whether a topic's name fits one of the patterns above."""
    return re.search(pattern, name.lower()) is not None
