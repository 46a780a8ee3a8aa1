# SPDX-License-Identifier: Apache-2.0
"""What a user can say about a log that the log does not say itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.errors import SettingsError
from slipwise.logs.unpacking import LARGEST_UNPACKED, MOST_UNPACKED


@dataclass(frozen=True)
class LogOptions:
    """How to read a log; whatever is None is guessed, and the guess is noted in the log.

    Raises:
        SettingsError: a length or a size is not a positive number.
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
    most_unpacked: float = MOST_UNPACKED  # [MiB] that a compressed table, or a chunk of a bag, may unpack to

    def __post_init__(self) -> None:
        for name in ("wheel_radius", "track", "wheelbase"):
            value: float | None = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise SettingsError(
                    f"{name} must be a positive number of metres, not {value}",
                    advice="measure it on the robot",
                )
        if not 0.0 < self.most_unpacked <= LARGEST_UNPACKED:
            raise SettingsError(
                f"most_unpacked must be a positive number of MiB, not {self.most_unpacked}",
                advice=f"the default is {MOST_UNPACKED:g}, the most {LARGEST_UNPACKED:g}",
            )
