# SPDX-License-Identifier: Apache-2.0
"""Turns the messages collected from a bag into raw streams of inputs and poses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.attitude import was_measured
from slipwise.logs.findings.finding import Notes
from slipwise.logs.findings.topics import NoRotation, ZeroCovariance, ZeroTwist
from slipwise.logs.findings.wheel_layout import layout_findings
from slipwise.logs.fixes import status_codes
from slipwise.logs.header_clock import BagClocks
from slipwise.logs.joints import speeds_from_angles
from slipwise.logs.kinematics import twist_from_steering, twist_from_wheels
from slipwise.logs.left_out import Tally
from slipwise.logs.log import ABSURD, OPTIONAL_POSE_COLUMNS, Bools, Floats, Inputs
from slipwise.logs.messages import ACKERMANN, JOINT_STATE, Samples, select
from slipwise.logs.navsat import angles_at, course_of_path, east_north_up, tilt_from_imu
from slipwise.logs.odometry_twist import always_zero, poses_move, twists_between
from slipwise.logs.options import LogOptions
from slipwise.logs.rotation import angles_of, unit_quaternions
from slipwise.logs.streams import RawStream
from slipwise.logs.vehicle_description import VehicleDescription
from slipwise.logs.wheel_readings import JointReadings, twists_of_wheels

_NO_CLOCKS = BagClocks(None, {})


@dataclass(frozen=True)
class BagContext:
    """What every stream of a bag needs to know."""

    file: str
    options: LogOptions
    tally: Tally
    notes: Notes  # what was worked out, and what was found to be wrong
    clocks: BagClocks = _NO_CLOCKS  # how headers and receipt go together

    def seconds(self, samples: Samples, role: str) -> Floats:
        """Return the stamps [N] in s: of the headers where there are any, else by the time of receipt."""
        received = samples.received_ns / 1e9
        if not samples.has_header:
            return self.clocks.by_receipt(received)
        stamps = self.clocks.dates(samples.topic, received, samples.stamp_ns / 1e9)
        zero = samples.stamp_ns == 0
        if not zero.any() or not (samples.received_ns[zero] != 0).any():
            return stamps
        self.tally.add(
            "zero-stamp",
            f"{role} stamps that are zero, replaced by the time of receipt",
            count=int(zero.sum()),
            where=f"{self.file}, {samples.topic} message {int(np.argmax(zero)) + 1}",
        )
        return np.where(zero, self.clocks.by_receipt(received), stamps)

    def stream(
        self, role: str, samples: Samples, columns: dict[str, Floats], keep: Bools | None = None
    ) -> RawStream:
        """Make a raw stream of the samples where `keep` [N] is true."""
        count = len(samples.received_ns)
        place = f"{self.file}, {samples.topic} message"
        whole = RawStream(
            role,
            self.seconds(samples, role),
            columns,
            np.arange(count),
            lambda row: f"{place} {row + 1}",
            frozenset(OPTIONAL_POSE_COLUMNS),
        )
        return whole if keep is None else whole.select(keep)


def command_stream(context: BagContext, samples: Samples, kind: str) -> RawStream:
    """Make the command stream of twists, or of a car's speed and steering angle.

    Raises:
        LogError: a steering angle came without a wheelbase.
    """
    if kind != ACKERMANN:
        v, vy, omega = samples.values.T
        return context.stream("commands", samples, {"v": v, "vy": vy, "omega": omega})
    if context.options.wheelbase is None:
        raise LogError(
            "steering commands need the wheelbase", where=samples.topic, advice="give --wheelbase in metres"
        )
    v, steer = samples.values.T
    factor, _ = context.options.command_scale
    v, omega = twist_from_steering(v, steer, wheelbase=context.options.wheelbase, speed_factor=factor)
    return context.stream("commands", samples, {"v": v, "omega": omega})


def wheel_stream(context: BagContext, samples: Samples, kind: str) -> RawStream:
    """Make the wheel stream of an odometry's twist, or of the speeds of wheels.

    Raises:
        LogError: speeds of wheels came without their radius and distance.
    """
    vehicle = context.options.wheels
    if kind == JOINT_STATE and vehicle is not None:
        return _layout_stream(context, samples, vehicle)
    if kind != JOINT_STATE:
        v, vy, omega = _odometry_twists(context, samples).T
        return context.stream("wheels", samples, {"v": v, "vy": vy, "omega": omega})
    radius, wheel_separation = context.options.wheel_radius, context.options.wheel_separation
    if radius is None or wheel_separation is None:
        raise LogError(
            "wheel speeds need the wheels' radius and the distance between left and right wheels",
            where=samples.topic,
            advice="give --wheel-radius and --wheel-separation in metres",
        )
    samples = _of_wheels(context, samples)
    left, right = _side_speeds(context, samples)
    v, omega = twist_from_wheels(left, right, wheel_radius=radius, wheel_separation=wheel_separation)
    return context.stream("wheels", samples, {"v": v, "omega": omega})


def _odometry_twists(context: BagContext, samples: Samples) -> Floats:
    """Return the twists [N, 3] of an odometry; of its poses where they move and the twist is always zero."""
    twists, poses = samples.values[:, :3], samples.values[:, 3:]
    if not always_zero(twists) or not poses_move(poses):
        return twists
    context.notes.append(ZeroTwist.of(samples.topic))
    return twists_between(context.seconds(samples, "wheels"), poses)


def _layout_stream(context: BagContext, samples: Samples, vehicle: VehicleDescription) -> RawStream:
    names, samples = JointReadings(vehicle).names, _of_wheels(context, samples)
    readings = dict(zip(names.all, samples.values.T, strict=True))
    t = context.seconds(samples, "wheels")
    found = twists_of_wheels(vehicle, names, readings, t)
    context.notes.append(f"{samples.topic}: {found.note(str(context.options.vehicle))}")
    context.notes.extend(layout_findings(vehicle, names, readings, t))
    return context.stream("wheels", samples, {"v": found.v, "vy": found.vy, "omega": found.omega})


def _of_wheels(context: BagContext, samples: Samples) -> Samples:
    """Leave out, and count, joint states without wheels, such as those of an arm."""
    there = np.asarray(np.isfinite(samples.values).any(axis=1))
    _count(context, samples, ~there, "no-wheel-joint", f"messages of {samples.topic} without a wheel's joint")
    return samples if there.all() else select(samples, there)


def _side_speeds(context: BagContext, samples: Samples) -> Floats:
    """Return the speeds [2, N] of the left and right wheels; of their angles where no speed is measured."""
    speeds, angles = samples.values[:, :2], samples.values[:, 2:]
    known = angles[np.isfinite(angles).all(axis=1)]
    turned = bool((known != known[:1]).any())
    measured = np.isfinite(speeds).all(axis=1) & (speeds != 0.0).any(axis=1)
    if turned and not measured.any():  # drivers without speeds leave them out, or send zeros
        context.notes.append(f"{samples.topic} has no wheel speeds: they are differences of its positions")
        speeds = speeds_from_angles(context.seconds(samples, "wheels"), angles)
    return np.asarray(speeds.T)


def pose_stream(context: BagContext, samples: Samples, inputs: Inputs | None = None) -> RawStream:
    """Make the pose stream of (x, y, z, quaternion[, variances]) [N, 7 or 10]; counts bad quaternions.

    Where none is a rotation they are positions, whose heading is the direction of the path: `inputs` tell
    which way the robot drove.
    """
    values = samples.values
    q, good = unit_quaternions(values[:, 3:7])
    if len(values) and not good.any() and np.isfinite(values[:, :2]).all(axis=1).any():
        return _position_stream(context, samples, inputs)
    roll, pitch, yaw = angles_of(q)
    columns = {"x": values[:, 0], "y": values[:, 1], "yaw": yaw, "frame": samples.frame.astype(np.float64)}
    for name, column in (("z", values[:, 2]), ("roll", roll), ("pitch", pitch)):
        if was_measured(column):
            columns |= {name: column}
    if values.shape[1] > 7:
        columns["std_xy"] = deviation_of(values[:, 7:9])
        columns["std_yaw"] = deviation_of(values[:, 9:10])
        if len(values) >= ZeroCovariance.FEWEST and not values[:, 7:10].any():
            context.notes.append(ZeroCovariance.of(samples.topic, len(values)))
    finite = np.isfinite(values[:, 3:7]).all(axis=1)
    _count(context, samples, finite & ~good, "bad-quaternion", "poses whose quaternion is not a rotation")
    return context.stream("poses", samples, columns, good | ~finite)


def _position_stream(context: BagContext, samples: Samples, inputs: Inputs | None) -> RawStream:
    """Make the stream of the positions of poses, none of which has a rotation."""
    values, t = samples.values, context.seconds(samples, "poses")
    known = np.asarray(np.isfinite(values[:, :2]).all(axis=1))
    yaw = np.full(len(values), np.nan)
    order = np.flatnonzero(known)[np.argsort(t[known], kind="stable")]
    yaw[order] = course_of_path(t[order], values[order, 0], values[order, 1], inputs)
    first = ", ".join(f"{value:g}" for value in values[0, 3:7])
    context.notes.append(NoRotation.of(samples.topic, len(values), first))
    columns = {"x": values[:, 0], "y": values[:, 1], "yaw": yaw, "frame": samples.frame.astype(np.float64)}
    if values.shape[1] > 7:
        columns["std_xy"] = deviation_of(values[:, 7:9])
    return replace(context.stream("poses", samples, columns, known), course=True)


def with_tilts(context: BagContext, poses: RawStream, imu: Samples | None) -> RawStream:
    """Give planar poses the roll and the pitch of an IMU, where one was named; poses in space keep theirs."""
    if imu is None or not len(imu.values) or "roll" in poses.columns or "pitch" in poses.columns:
        return poses
    orientation = _orientation(context, imu)
    if orientation is None:
        return poses
    context.notes.append(f"roll and pitch are those of {imu.topic}")
    return replace(poses, columns={**poses.columns, **orientation.tilts_at(poses.t)})


@dataclass(frozen=True, eq=False)
class _Orientation:
    """What an IMU said of its orientation, [M] each."""

    t: Floats  # s
    roll: Floats  # rad
    pitch: Floats
    yaw: Floats

    def tilts_at(self, t: Floats) -> dict[str, Floats]:
        """Return roll and pitch at stamps [N]; NaN where no sample was near enough."""
        return {
            "roll": tilt_from_imu(t, self.t, self.roll),
            "pitch": tilt_from_imu(t, self.t, self.pitch),
        }


def _orientation(context: BagContext, imu: Samples) -> _Orientation | None:
    """Read an IMU's orientations and count messages without one; None where all are."""
    q, upright = unit_quaternions(imu.values)
    _count(context, imu, ~upright, "bad-quaternion", "imu messages without an orientation")
    if not upright.any():
        return None
    return _Orientation(context.seconds(imu, "imu")[upright], *angles_of(q[upright]))


def fix_stream(
    context: BagContext, samples: Samples, imu: Samples | None, inputs: Inputs | None
) -> RawStream:
    """Make the pose stream of satellite fixes (latitude, longitude, altitude, status, variances) [N, 6].

    Heading, roll and pitch are the IMU's where there is one; otherwise they are positions, and their heading
    is the direction of the path.
    """
    values = samples.values
    position = np.isfinite(values[:, :2]).all(axis=1)
    good = position & (values[:, 3] >= 0.0)
    _count(context, samples, ~good, "no-fix", "satellite messages without a fix")
    altitude = np.nan_to_num(values[:, 2])
    x, y, z = (np.full(len(values), np.nan) for _ in range(3))
    if good.any():
        x[good], y[good], z[good] = east_north_up(values[good, 0], values[good, 1], altitude[good]).T
    yaw, known = np.full(len(values), np.nan), np.zeros(len(values), bool)
    tilts: dict[str, Floats] = {}
    t = context.seconds(samples, "poses")
    if imu is not None and len(imu.values):
        orientation = _orientation(context, imu)
        if orientation is not None:
            yaw, known = angles_at(t, orientation.t, orientation.yaw)
            tilts = orientation.tilts_at(t)
    course = not known.any()
    if course:
        order = np.flatnonzero(good)[np.argsort(t[good], kind="stable")]
        yaw[order], known[order] = course_of_path(t[order], x[order], y[order], inputs), True
        context.notes.append(f"{samples.topic} has no headings: they are the direction of the path")
    else:
        context.notes.append("headings, roll and pitch are those of the IMU")
    _count(context, samples, good & ~known, "no-heading", "satellite fixes without a heading")
    columns = {"x": x, "y": y, "z": z, "yaw": yaw, "std_xy": deviation_of(values[:, 4:6]), **tilts}
    if len(np.unique(values[good, 3])) > 1:  # errors of each sort of fix are a population of their own
        columns["fix"] = status_codes(values[:, 3])
    return replace(context.stream("poses", samples, columns, good & known), course=course)


def gyro_stream(context: BagContext, samples: Samples) -> RawStream:
    """Make the stream of yaw rates about the z axis of an IMU, which REP-103 points up."""
    rate = samples.values[:, 0] if len(samples.values) else np.empty(0)
    known = np.isfinite(rate)
    _count(context, samples, ~known, "no-gyro", "imu messages without a yaw rate")
    context.notes.append(f"yaw rates are those of {samples.topic}")
    return context.stream("gyro", samples, {"gyro_z": rate}, known)


def force_stream(context: BagContext, samples: Samples) -> RawStream:
    """Make the stream of known forces over the robot's mass."""
    x, y = samples.values.T
    return context.stream("forces", samples, {"force_x": x, "force_y": y})


def deviation_of(variances: Floats) -> Floats:
    """Return the standard deviation [N] of variances [N, K], NaN unless all are positive and can be."""
    known = (variances > 0.0) & (variances < ABSURD)  # false for NaN
    return np.asarray(np.sqrt(np.where(known, variances, np.nan).mean(axis=1)))


def _count(context: BagContext, samples: Samples, wrong: Bools, kind: str, reason: str) -> None:
    where = f"{context.file}, {samples.topic} message {int(np.argmax(wrong)) + 1}"
    context.tally.add(kind, reason, count=int(wrong.sum()), where=where)
