# SPDX-License-Identifier: Apache-2.0
"""ROS messages as samples: the numbers that are taken out of a bag, one message at a time."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from slipwise.errors import SettingsError
from slipwise.live.one_rotation import deviation, rotation_of
from slipwise.live.samples import Command, Pose, Reading, Wheels
from slipwise.logs.attitude import was_measured
from slipwise.logs.corrections import OneAttitude, late_by, turned_one
from slipwise.logs.findings.topics import ZeroCovariance, ZeroTwist
from slipwise.logs.findings.wheel_layout import LayoutWatch
from slipwise.logs.fixes import fix_of_status
from slipwise.logs.gyro import COLUMN as GYRO
from slipwise.logs.joints import SideMotion
from slipwise.logs.kinematics import twist_from_steering, twist_from_wheels
from slipwise.logs.messages import (
    ACKERMANN,
    COMMAND_VALUES,
    GYRO_VALUES,
    IMU_VALUES,
    JOINT_STATE,
    NAV_SAT_FIX,
    POSE_VALUES,
    WHEEL_VALUES,
    Values,
)
from slipwise.logs.navsat import ecef, in_tangent_plane
from slipwise.logs.odometry_twist import always_zero, poses_move, twists_between
from slipwise.logs.options import LogOptions
from slipwise.logs.vehicle_description import VehicleDescription
from slipwise.logs.wheel_readings import JointReadings, twists_of_wheels

OLDEST_IMU = 0.2  # s; an older orientation says nothing of a pose


def _nobody(_: str) -> None:
    """Has no listener."""


ToCommand = Callable[[Any, float], Command | None]
ToWheels = Callable[[Any, float], Wheels | None]
ToPose = Callable[[Any, float], Pose | None]


def to_command(kind: str, options: LogOptions) -> ToCommand:
    """Return what makes a command of a message of type `kind` and its stamp [s].

    Raises:
        SettingsError: a steering angle needs the wheelbase.
    """
    values, (scale_v, scale_omega) = COMMAND_VALUES[kind], options.command_scale
    if kind != ACKERMANN:

        def twist(message: Any, t: float) -> Command:
            v, vy, omega = values(message)
            return Command(t, scale_v * v, scale_omega * omega, scale_v * vy)

        return twist
    wheelbase = options.wheelbase
    if wheelbase is None:
        raise SettingsError("steering commands need the wheelbase", advice="give --wheelbase in metres")

    def steering(message: Any, t: float) -> Command:
        v, steer = (np.array([value]) for value in values(message))
        v, omega = twist_from_steering(v, steer, wheelbase=wheelbase, speed_factor=scale_v)
        return Command(t, scale_v * float(v[0]), scale_omega * float(omega[0]))

    return steering


def to_wheels(
    kind: str,
    options: LogOptions,
    say: Callable[[str], None] = _nobody,
    topic: str = "",
    layout: LayoutWatch | None = None,
) -> ToWheels:
    """Return what makes a wheel twist of a message of type `kind` and its stamp [s].

    `say` is called with what is found of `topic`; `layout` keeps the readings of described wheels.

    Raises:
        SettingsError: joint states need the sizes of the robot.
    """
    scale_v, scale_omega = options.wheel_scale
    if kind != JOINT_STATE:
        odometry = _OdometryTwists(lambda: say(ZeroTwist.of(topic).sentence))

        def twist(message: Any, t: float) -> Wheels:
            held, v, vy, omega = odometry.take(WHEEL_VALUES[kind](message), t)
            return Wheels(held, scale_v * v, scale_omega * omega, scale_v * vy)

        return twist
    if options.wheels is not None:
        return _layout_wheels(options.wheels, options.wheel_scale, layout)
    radius, separation = options.wheel_radius, options.wheel_separation
    if radius is None or separation is None:
        raise SettingsError(
            "wheel speeds need the wheels' radius and their distance",
            advice="give --wheel-radius and --wheel-separation in metres",
        )
    sides = _SideSpeeds(options)

    def joints(message: Any, t: float) -> Wheels | None:
        left, right = (np.array([speed]) for speed in sides.take(message, t))
        if not (np.isfinite(left) & np.isfinite(right)).all():
            return None
        v, omega = twist_from_wheels(left, right, wheel_radius=radius, wheel_separation=separation)
        return Wheels(t, scale_v * float(v[0]), scale_omega * float(omega[0]))

    return joints


class _OdometryTwists:
    """Twists of an odometry; differences of its poses where these move and the twist was always zero."""

    def __init__(self, say: Callable[[], None]) -> None:
        self._say = say
        self._measured = False  # a twist said that something moves
        self._first: list[float] | None = None  # pose
        self._last: tuple[float, list[float]] | None = None  # stamp [s] and pose
        self._differences = False

    def take(self, values: Values, t: float) -> tuple[float, float, float, float]:
        """Return from when on [s] which twist (v, vy, omega) holds."""
        twist, pose = list(values[:3]), list(values[3:])
        self._measured = self._measured or not always_zero(np.array([twist]))
        self._first = self._first or pose
        last, self._last = self._last, (t, pose)
        if not self._measured and not self._differences and poses_move(np.array([self._first, pose])):
            self._differences = True
            self._say()
        if self._measured or not self._differences or last is None or not t > last[0]:
            return (t, *values[:3])  # type: ignore[return-value]
        v, vy, omega = twists_between(np.array([last[0], t]), np.array([last[1], pose]))[0].tolist()
        return last[0], v, vy, omega


def _layout_wheels(
    vehicle: VehicleDescription, scale: tuple[float, float], layout: LayoutWatch | None
) -> ToWheels:
    """Return what makes a wheel twist of all wheels that the vehicle names."""
    read, last = JointReadings(vehicle), dict[str, float]()

    def joints(message: Any, t: float) -> Wheels | None:
        read.check(message)
        values = dict(zip(read.names.all, read(message), strict=True))
        rows = {name: np.array([last.get(name, value), value]) for name, value in values.items()}
        found = twists_of_wheels(vehicle, read.names, rows, np.array([last.get("t", t), t]))
        if all(map(math.isfinite, values.values())):
            last.update({**values, "t": t})
            if layout is not None:
                layout.take(values, t)
        v, vy, omega = float(found.v[1]), float(found.vy[1]), float(found.omega[1])
        if not math.isfinite(v + vy + omega):
            return None
        return Wheels(t, scale[0] * v, scale[1] * omega, scale[0] * vy)

    return joints


class _SideSpeeds:
    """Speeds of the sides [rad/s]; differences of the angles for drivers that measure no speed."""

    def __init__(self, options: LogOptions) -> None:
        self._motion = SideMotion(options)
        self._last: tuple[float, float, float] | None = None
        self._measured = False

    def take(self, message: Any, t: float) -> tuple[float, float]:
        self._motion.check(message)
        left, right, *angles = self._motion(message)
        last, self._last = self._last, (t, angles[0], angles[1])
        self._measured = self._measured or (math.isfinite(left) and (left != 0.0 or right != 0.0))
        if self._measured or last is None or not t > last[0]:
            return left, right
        return (angles[0] - last[1]) / (t - last[0]), (angles[1] - last[2]) / (t - last[0])


class _Covariances:
    """Says that the first poses of a topic have no other covariance than zeros."""

    def __init__(self, say: Callable[[int], None]) -> None:
        self._say = say
        self._looked_at = 0

    def take(self, *variances: float) -> None:
        if self._looked_at < ZeroCovariance.FEWEST:
            self._looked_at = ZeroCovariance.FEWEST + 1 if any(variances) else self._looked_at + 1
            if self._looked_at == ZeroCovariance.FEWEST:
                self._say(self._looked_at)


class FirstPoses(NamedTuple):
    """What the first poses show."""

    positions: bool = False  # they have no rotation: they are positions, as `calibrate` takes them
    attitude: bool = False  # roll and pitch are measured, as `calibrate` sees it: terms of gravity are tried
    tilts: bool = False  # by the poses themselves, not by an IMU beside them


NOTHING_SEEN = FirstPoses()


class ImuOrientation:
    """The last orientation that an IMU had."""

    def __init__(self) -> None:
        self._last: tuple[float, OneAttitude] | None = None  # stamp [s]

    def take(self, message: Any, t: float) -> None:
        """Take a message; one without an orientation changes nothing."""
        angles = rotation_of(*_values(IMU_VALUES, message))
        if angles is not None:
            roll, pitch, yaw = angles
            self._last = (t, (yaw, roll, pitch))

    def at(self, t: float) -> OneAttitude | None:
        """Return (yaw, roll, pitch) [rad] at a stamp [s]; None where the last is of another time."""
        return None if self._last is None or abs(t - self._last[0]) > OLDEST_IMU else self._last[1]


class _Tilts:
    """Roll and pitch of poses: a topic's quaternions measure them, or an IMU beside it."""

    def __init__(self, imu: ImuOrientation | None, *, known: bool) -> None:
        self._imu = imu
        self._roll = self._pitch = known

    def take(self, roll: float, pitch: float, t: float) -> tuple[float | None, float | None]:
        """Return roll and pitch at a stamp [s]: those given where both were measured by now."""
        if not (self._roll and self._pitch):
            self._roll = self._roll or was_measured(roll)
            self._pitch = self._pitch or was_measured(pitch)
        if self._roll and self._pitch:
            return roll, pitch
        oriented = None if self._imu is None else self._imu.at(t)
        return (None, None) if oriented is None else oriented[1:]


def to_pose(  # noqa: PLR0913 - the last four have defaults
    kind: str,
    options: LogOptions,
    say: Callable[[str], None] = _nobody,
    topic: str = "",
    seen: FirstPoses = NOTHING_SEEN,
    imu: ImuOrientation | None = None,
) -> ToPose:
    """Return what makes a pose of a message of type `kind` and its stamp [s]; not of satellite fixes.

    `say` is called with what is found of `topic`.
    A quaternion that is no rotation is a position where poses were `seen` as such: its yaw is NaN.
    Unless tilts were seen, poses have a roll and a pitch from when on both were measured; before, those
    of the `imu`, as `calibrate` gives them to planar poses.
    """
    values, offset, late = POSE_VALUES[kind], options.pose_yaw_offset, late_by(options)
    tilts = _Tilts(imu, known=seen.tilts)
    covariances = _Covariances(lambda count: say(ZeroCovariance.of(topic, count).sentence))

    def pose(message: Any, t: float) -> Pose | None:
        x, y, z, *rest = values(message)
        qx, qy, qz, qw, var_x, var_y, var_yaw = rest
        covariances.take(var_x, var_y, var_yaw)
        angles = rotation_of(qx, qy, qz, qw)
        std_xy, std_yaw = deviation(var_x, var_y), deviation(var_yaw)
        if angles is None and not seen.positions:
            raise ValueError(
                f"the quaternion ({qx:g}, {qy:g}, {qz:g}, {qw:g}) is not a rotation; where no pose has one, "
                "--set live.positions=true uses the positions alone"
            )
        if angles is None:
            return Pose(t + late, x, y, math.nan, std_xy, frame=message.header.frame_id, z=z)
        roll, pitch, yaw = angles
        robot = turned_one((yaw, *tilts.take(roll, pitch, t)), offset)
        return Pose(t + late, x, y, robot[0], std_xy, std_yaw, message.header.frame_id, *robot[1:], z=z)

    return pose


def to_gyro(message: Any, t: float) -> Reading | None:
    """Return the yaw rate of an Imu, which REP-103 counts about the z axis, up."""
    (rate,) = _values(GYRO_VALUES, message)
    return Reading(t, GYRO, rate) if math.isfinite(rate) else None


class FixPoses:
    """Poses of satellite fixes with the orientation of an IMU, in the tangent plane at the first fix.

    Without an IMU they are positions: their yaw is NaN.
    """

    def __init__(self, options: LogOptions, imu: ImuOrientation | None) -> None:
        self._imu, self._late = imu, late_by(options)
        self._offset = options.pose_yaw_offset
        self._origin: tuple[float, float, float] | None = None

    def take(self, message: Any, t: float) -> Pose | None:
        """Return the pose of a fix; None without a fix, or without a heading of the same time."""
        latitude, longitude, altitude, status, *variances = POSE_VALUES[NAV_SAT_FIX](message)
        if not (math.isfinite(latitude) and math.isfinite(longitude)) or status < 0.0:
            return None
        fix = (latitude, longitude, altitude if math.isfinite(altitude) else 0.0)
        self._origin = self._origin or fix
        x, y, z = in_tangent_plane(ecef(*_row(fix)), *_row(self._origin))[0].tolist()
        std_xy, sort = deviation(*variances), fix_of_status(status)
        frame = message.header.frame_id
        if self._imu is None:
            return Pose(t + self._late, x, y, math.nan, std_xy, frame=frame, fix=sort, z=z)
        oriented = self._imu.at(t)
        if oriented is None:
            return None
        yaw, roll, pitch = turned_one(oriented, self._offset)
        return Pose(t + self._late, x, y, yaw, std_xy, frame=frame, roll=roll, pitch=pitch, fix=sort, z=z)


def _row(fix: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    latitude, longitude, altitude = (np.array([value]) for value in fix)
    return latitude, longitude, altitude


def _values(table: dict[str, Callable[[Any], Values]], message: Any) -> Values:
    (values,) = table.values()
    return values(message)
