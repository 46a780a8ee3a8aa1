# SPDX-License-Identifier: Apache-2.0
"""ros2_control's `diff_drive_controller`: multipliers, covariance diagonals and the range of speeds."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.measured_limits import MeasuredLimits
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, for_release, stated
from slipwise.export.reference_drive import (
    learned_variances,
    motion_covariance,
    reference_drive,
    slip_density,
)
from slipwise.export.ros_tables import DIFF_DRIVE, checked_distro
from slipwise.export.wheel_multipliers import WheelMultipliers, wheel_multipliers
from slipwise.models.model import Model

PUBLISH_RATE = 50.0  # Hz, the controller's default where it has one
UNMEASURED = 1.0e6  # variance of what wheels say nothing about: height, roll, pitch and their rates


def diff_drive(model: Model, options: ExportOptions) -> ParameterFile:
    """Return the parameters of a diff_drive_controller.

    Raises:
        ModelError: the model was learned from commands, or is of an Ackermann vehicle.
    """
    if options.min_turning_radius is not None:
        raise ModelError(
            "a vehicle with a smallest turning radius has no diff_drive_controller",
            advice="leave --min-turning-radius out, or export another file",
        )
    if model.content.input != "wheel":
        raise ModelError(
            "wheel multipliers need a model learned from wheel speeds, this one is from commands",
            advice="calibrate with `--input wheel`",
        )
    distro = checked_distro(options.ros_distro, "diff_drive_controller")
    found = wheel_multipliers(model, options)
    limits = _limits(model, distro) if options.limits else []
    notes = [_names(options, distro), _left_over(found)]
    return ParameterFile(
        node="diff_drive_controller",
        entries=for_release(
            [*_geometry(found, options, model), *_covariances(model, options, distro), *limits],
            DIFF_DRIVE,
            distro,
        ),
        notes=notes if options.limits else [*notes, _NO_LIMITS],
    )


_NO_LIMITS = """\
Limits of speed are left as they are: a log shows how the robot was driven, not what it may do. `--limits`
writes what the poses show."""


def _names(options: ExportOptions, distro: str) -> str:
    separation, radius = options.logged_separation_multiplier, options.logged_radius_multiplier
    return (
        f"Names of ros2_controllers' diff_drive_controller for ROS 2 {distro.capitalize()}.\n"
        "A running controller refuses multipliers and covariances: restart it with this file.\n"
        "The multipliers replace those that were in force while the log was recorded"
        f" (separation {separation:g}, radius {radius:g}).\n"
        "They change what the robot does with a command, too: calibrate from commands again afterwards."
    )


def _left_over(found: WheelMultipliers) -> str:
    forward, sideways, yaw = found.residual
    return (
        "What multipliers cannot express of this model, RMS over the range:"
        f" forward {forward:.2g} m/s, sideways {sideways:.2g} m/s, yaw {yaw:.2g} rad/s."
    )


def _geometry(found: WheelMultipliers, options: ExportOptions, model: Model) -> list[Entry | Kept]:
    numbers = LearnedNumbers(model)
    sides = (
        "one factor for both sides: give --wheel-separation to tell them apart"
        if options.wheel_separation is None
        else "from how the robot turns while its wheels go straight"
    )
    separation = (
        []
        if options.wheel_separation is None
        else [Entry(("wheel_separation",), options.wheel_separation, "[m] nominal, as given", supposed=True)]
    )
    named = (
        ("wheel_separation_multiplier", found.separation, ""),
        ("left_wheel_radius_multiplier", found.left_radius, f"; {sides}"),
        ("right_wheel_radius_multiplier", found.right_radius, f"; {sides}"),
    )
    return [
        *separation,
        *(stated((name,), number, f"{numbers.text(number)}{how}", numbers) for name, number, how in named),
    ]


def _rate(options: ExportOptions, distro: str) -> tuple[float | None, list[Entry | Kept]]:
    """Return how often odometry is published [Hz], and the parameters of the controller for it."""
    if "publish_rate" not in DIFF_DRIVE.of_distro(distro):
        return options.update_rate, []
    rate = PUBLISH_RATE if options.update_rate is None else min(PUBLISH_RATE, options.update_rate)
    why = "[Hz] the twist's covariance below is for this rate"
    return rate, [Entry(("publish_rate",), rate, why, supposed=True)]


def _covariances(model: Model, options: ExportOptions, distro: str) -> list[Entry | Kept]:
    drive, numbers = reference_drive(model), LearnedNumbers(model)
    at, seconds = (drive.speed, drive.yaw_rate), options.horizon
    where = f"at {drive.speed:.3g} m/s and {drive.yaw_rate:.3g} rad/s"
    rate, parameters = _rate(options, distro)
    twist = learned_variances(model, lambda each: slip_density(each, at, seconds) * (rate or 1.0))
    pose = learned_variances(model, lambda each: motion_covariance(each, at, seconds).diagonal())
    return [
        *parameters,
        Kept((_TWIST,), _NO_RATE + _shown(twist))
        if rate is None
        else _diagonal(
            _TWIST,
            twist,
            numbers,
            f"[m^2/s^2, rad^2/s^2] {where}: the density of the slip noise times\n"
            f"the {rate:g} messages a second, so that a filter that takes each as new is as unsure after"
            f" {seconds:g} s as the model is",
        ),
        _diagonal(
            "pose_covariance_diagonal",
            pose,
            numbers,
            f"[m^2, rad^2] {where}: inflation within {seconds:g} s. The controller never lets it grow,\n"
            "so fuse the twist, or the pose as differences, never the pose itself",
        ),
    ]


_TWIST = "twist_covariance_diagonal"
_NO_RATE = """\
since May 2026 odometry comes at the controller manager's update_rate, 100 to 1000 Hz, and the covariance
of each message is in proportion to it: give --update-rate. For 1 Hz, x, y and yaw: """


def _shown(planar: Sequence[LearnedNumber]) -> str:
    return ", ".join(f"{number.value:.3g}" for number in planar)


def _diagonal(
    name: str, planar: Sequence[LearnedNumber], numbers: LearnedNumbers, meaning: str
) -> Entry | Kept:
    """Return a diagonal of x, y, z, roll, pitch and yaw, of which three are learned: all of them, or none."""
    objections = [why for why in map(numbers.objection, planar) if why]
    if objections:
        return Kept((name,), objections[0])
    x, y, yaw = (number.value for number in planar)
    return Entry((name,), [x, y, UNMEASURED, UNMEASURED, UNMEASURED, yaw], meaning)


def _limits(model: Model, distro: str) -> list[Entry | Kept]:
    numbers = LearnedNumbers(model)
    measured = MeasuredLimits(model, numbers)
    turn = measured.top_yaw_rate()
    named = (
        ("linear.x.max_velocity", measured.top_speed(), 1.0, "m/s"),
        ("linear.x.min_velocity", measured.top_speed_back(), -1.0, "m/s"),
        ("angular.z.max_velocity", turn, 1.0, "rad/s"),
        ("angular.z.min_velocity", turn, -1.0, "rad/s"),
    )
    entries: list[Entry | Kept] = [
        Kept((name,), limit)
        if isinstance(limit, str)
        else Entry((name,), limit.number.value * sign, f"[{unit}] of the body, {limit.source}")
        for name, limit, sign, unit in named
    ]
    asks = [name for name in DIFF_DRIVE.of_distro(distro) if name.endswith("has_velocity_limits")]
    if all(isinstance(entry, Entry) for entry in entries):
        entries += [Entry((name,), True, "without it the limits above have no effect") for name in asks]
    return entries
