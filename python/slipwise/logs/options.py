# SPDX-License-Identifier: Apache-2.0
"""What a user can say about a log that the log does not say itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.errors import SettingsError


@dataclass(frozen=True)
class LogOptions:
    """How to read a log; whatever is None is guessed, and the guess is noted in the log.

    Raises:
        SettingsError: a length is not a positive number, a factor is 0 or an angle no number.
    """

    command_topic: str | None = None  # Twist[Stamped] or AckermannDriveStamped
    pose_topic: str | None = None  # Odometry, Pose[WithCovariance]Stamped, NavSatFix or TFMessage
    wheel_topic: str | None = None  # Odometry (its twist) or JointState
    imu_topic: str | None = None  # Imu: the heading beside a NavSatFix
    pose_frame: str | None = None  # TF: the fixed frame, such as "map"
    child_frame: str | None = None  # TF: the robot, such as "base_link"
    left_joints: tuple[str, ...] = ()  # JointState: wheels of the left side, by name
    right_joints: tuple[str, ...] = ()
    wheel_radius: float | None = None  # [m]
    track: float | None = None  # [m] between the left and the right wheels
    wheelbase: float | None = None  # [m] between the axles, for steering angles
    command_scale: tuple[float, float] = (1.0, 1.0)  # factors of the commanded speed and yaw rate
    wheel_scale: tuple[float, float] = (1.0, 1.0)  # the same of the wheels'; such as their radius, or -1
    pose_yaw_offset: float = 0.0  # [rad] added to the heading of every pose

    def __post_init__(self) -> None:
        for name in ("wheel_radius", "track", "wheelbase"):
            value: float | None = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise SettingsError(
                    f"{name} must be a positive number of metres, not {value}",
                    advice="measure it on the robot",
                )
        for name in ("command_scale", "wheel_scale"):
            factors: tuple[float, ...] = getattr(self, name)
            if len(factors) != 2 or not all(math.isfinite(factor) and factor != 0.0 for factor in factors):
                raise SettingsError(
                    f"{name} must be two factors, of speed and yaw rate, neither of them 0",
                    advice="such as 0.15,1 for wheels of 0.15 m whose speed is in rad/s, or -1,1 for a sign",
                )
        if not math.isfinite(self.pose_yaw_offset):
            raise SettingsError("pose_yaw_offset must be a number of radians", advice="3.1416 is half a turn")
