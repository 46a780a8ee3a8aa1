# SPDX-License-Identifier: Apache-2.0
"""What is taken out of each type of ROS message, as plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from slipwise.logs.log import Bools, Floats, Ints
from slipwise.logs.odometry_twist import twist_and_pose

Values = tuple[float, ...]

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
ACKERMANN = "ackermann_msgs/msg/AckermannDriveStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
POSE_WITH_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped"
IMU = "sensor_msgs/msg/Imu"
JOINT_STATE = "sensor_msgs/msg/JointState"
NAV_SAT_FIX = "sensor_msgs/msg/NavSatFix"
ACCEL_STAMPED = "geometry_msgs/msg/AccelStamped"
TF = "tf2_msgs/msg/TFMessage"

COMMAND_TYPES = (TWIST, TWIST_STAMPED, ACKERMANN)
POSE_TYPES = (ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE, NAV_SAT_FIX, TF)
WHEEL_TYPES = (ODOMETRY, JOINT_STATE)

TF_DEFINITION = "geometry_msgs/TransformStamped[] transforms\n"
ACKERMANN_DEFINITION = """std_msgs/Header header
ackermann_msgs/AckermannDrive drive
================================================================================
MSG: ackermann_msgs/AckermannDrive
float32 steering_angle
float32 steering_angle_velocity
float32 speed
float32 acceleration
float32 jerk
"""


@dataclass(frozen=True, eq=False)
class Samples:
    """The numbers of one topic's messages, in the order of the bag."""

    topic: str
    stamp_ns: Ints  # [N] of the header, 0 where there is none
    received_ns: Ints  # [N] when the message was recorded
    values: Floats  # [N, K]
    frame_ids: tuple[str, ...]  # the distinct ones
    frame: Ints  # [N] index into frame_ids
    has_header: bool


def twist_values(message: Any) -> Values:
    """(v, vy, omega) of a geometry_msgs/Twist."""
    return (message.linear.x, message.linear.y, message.angular.z)


def _ackermann_values(message: Any) -> Values:
    return (message.drive.speed, message.drive.steering_angle)


def _pose_values(pose: Any) -> Values:
    p, q = pose.position, pose.orientation
    return (p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def _with_covariance(pose: Any) -> Values:
    covariance = pose.covariance
    return (*_pose_values(pose.pose), covariance[0], covariance[7], covariance[35])


def _odometry_values(message: Any) -> Values:
    """Return a pose with its variances; zeros are a covariance that its publisher does not fill."""
    values = _with_covariance(message.pose)
    return values if any(values[7:]) else (*values[:7], *_UNKNOWN)


def _fix_values(message: Any) -> Values:
    covariance = message.position_covariance
    known = message.position_covariance_type > 0
    variance = (covariance[0], covariance[4]) if known else (math.nan, math.nan)
    return (message.latitude, message.longitude, message.altitude, float(message.status.status), *variance)


def _imu_values(message: Any) -> Values:
    if message.orientation_covariance[0] == -1.0:  # the message's way to say that there is no orientation
        return (0.0, 0.0, 0.0, 0.0)
    q = message.orientation
    return (q.x, q.y, q.z, q.w)


def _yaw_rate(message: Any) -> Values:
    if message.angular_velocity_covariance[0] == -1.0:  # the message's way to say that there is no gyro
        return (math.nan,)
    return (message.angular_velocity.z,)


_UNKNOWN = (math.nan, math.nan, math.nan)

COMMAND_VALUES: dict[str, Callable[[Any], Values]] = {
    TWIST: twist_values,
    TWIST_STAMPED: lambda message: twist_values(message.twist),
    ACKERMANN: _ackermann_values,
}
POSE_VALUES: dict[str, Callable[[Any], Values]] = {
    ODOMETRY: _odometry_values,
    POSE_STAMPED: lambda message: (*_pose_values(message.pose), *_UNKNOWN),
    POSE_WITH_COVARIANCE: lambda message: _with_covariance(message.pose),
    NAV_SAT_FIX: _fix_values,
}
WHEEL_VALUES: dict[str, Callable[[Any], Values]] = {
    ODOMETRY: twist_and_pose,
}
FORCE_VALUES: dict[str, Callable[[Any], Values]] = {  # over the mass
    ACCEL_STAMPED: lambda message: (message.accel.linear.x, message.accel.linear.y),
}
IMU_VALUES: dict[str, Callable[[Any], Values]] = {IMU: _imu_values}
GYRO_VALUES: dict[str, Callable[[Any], Values]] = {IMU: _yaw_rate}


#: What a message raises that was decoded without a definition of its type, as JSON is.
WRONG_CONTENT = (AttributeError, IndexError, OverflowError, TypeError, ValueError)


def stamp_of(header: Any) -> int:
    """Return the stamp [ns] of a header whose frame has a name.

    Raises:
        Exception: one of `WRONG_CONTENT`.
    """
    if not isinstance(header.frame_id, str):
        raise TypeError("a frame's name is a text")
    return time_of(header.stamp)


def time_of(stamp: Any) -> int:
    """Return a time in ns.

    Raises:
        Exception: one of `WRONG_CONTENT`.
    """
    time = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
    if abs(time) >= 1 << 63:
        raise OverflowError("an impossible stamp")
    return time


def select(samples: Samples, keep: Bools) -> Samples:
    """Return the messages where `keep` [N] is true."""
    return replace(
        samples,
        stamp_ns=samples.stamp_ns[keep],
        received_ns=samples.received_ns[keep],
        values=samples.values[keep],
        frame=samples.frame[keep],
    )


class SampleCollector:
    """Collects one topic's messages through one of the functions above."""

    def __init__(self, topic: str, values: Callable[[Any], Values], *, has_header: bool) -> None:
        self._topic, self._values, self._has_header = topic, values, has_header
        self._stamps: list[int] = []
        self._received: list[int] = []
        self._rows: list[Values] = []
        self._frames: list[int] = []
        self._frame_ids: dict[str, int] = {}

    def add(self, message: Any, received_ns: int) -> None:
        """Take one message, or nothing of it.

        Raises:
            Exception: one of `WRONG_CONTENT`: it lacks a field or holds something else than a number there.
        """
        row = tuple(map(float, self._values(message)))
        stamp, frame = 0, 0
        if self._has_header:
            stamp = stamp_of(message.header)
            frame = self._frame_ids.setdefault(message.header.frame_id, len(self._frame_ids))
        self._rows.append(row)
        self._received.append(received_ns)
        self._stamps.append(stamp)
        self._frames.append(frame)

    def result(self) -> Samples:
        """Return all that was collected."""
        count = len(self._rows)
        values = np.array(self._rows, dtype=np.float64) if count else np.empty((0, 0))
        return Samples(
            topic=self._topic,
            stamp_ns=np.array(self._stamps, dtype=np.int64),
            received_ns=np.array(self._received, dtype=np.int64),
            values=values,
            frame_ids=tuple(self._frame_ids) or ("",),
            frame=np.array(self._frames, dtype=np.int64),
            has_header=self._has_header,
        )
