# SPDX-License-Identifier: Apache-2.0
"""ros2_control's `diff_drive_controller`: multipliers, covariance diagonals and the range of speeds."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, stated
from slipwise.export.reference_drive import (
    learned_variances,
    motion_covariance,
    reference_drive,
    slip_density,
)
from slipwise.export.wheel_multipliers import WheelMultipliers, wheel_multipliers
from slipwise.models.model import Model

PUBLISH_RATE = 50.0  # Hz, the controller's default
_SPEED = "[m/s] of the body, as far as the log went"
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
    found = wheel_multipliers(model, options)
    return ParameterFile(
        node="diff_drive_controller",
        entries=[*_geometry(found, options, model), *_covariances(model, options), *_limits(model, found)],
        notes=[_names(options), _left_over(found)],
    )


def _names(options: ExportOptions) -> str:
    separation, radius = options.logged_separation_multiplier, options.logged_radius_multiplier
    return (
        "Names of ros2_controllers' diff_drive_controller for ROS 2 Jazzy and later; Humble also wants\n"
        "linear.x.has_velocity_limits and angular.z.has_velocity_limits set to true.\n"
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
        else [Entry(("wheel_separation",), options.wheel_separation, "[m] nominal, as given")]
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


def _covariances(model: Model, options: ExportOptions) -> list[Entry | Kept]:
    drive, numbers = reference_drive(model), LearnedNumbers(model)
    at, seconds = (drive.speed, drive.yaw_rate), options.horizon
    where = f"at {drive.speed:.3g} m/s and {drive.yaw_rate:.3g} rad/s"
    twist = learned_variances(model, lambda each: slip_density(each, at, seconds) * PUBLISH_RATE)
    pose = learned_variances(model, lambda each: motion_covariance(each, at, seconds).diagonal())
    return [
        Entry(("publish_rate",), PUBLISH_RATE, "[Hz] the twist's covariance below is for this rate"),
        _diagonal(
            "twist_covariance_diagonal",
            twist,
            numbers,
            f"[m^2/s^2, rad^2/s^2] {where}: the density of the slip noise times the rate, so that a\n"
            f"filter that takes every message as new is as unsure after {seconds:g} s as the model is",
        ),
        _diagonal(
            "pose_covariance_diagonal",
            pose,
            numbers,
            f"[m^2, rad^2] {where}: inflation within {seconds:g} s. The controller never lets it grow,\n"
            "so fuse the twist, or the pose as differences, never the pose itself",
        ),
    ]


def _diagonal(
    name: str, planar: Sequence[LearnedNumber], numbers: LearnedNumbers, meaning: str
) -> Entry | Kept:
    """Return a diagonal of x, y, z, roll, pitch and yaw, of which three are learned: all of them, or none."""
    objections = [why for why in map(numbers.objection, planar) if why]
    if objections:
        return Kept((name,), objections[0])
    x, y, yaw = (number.value for number in planar)
    return Entry((name,), [x, y, UNMEASURED, UNMEASURED, UNMEASURED, yaw], meaning)


def _limits(model: Model, found: WheelMultipliers) -> list[Entry | Kept]:
    span, numbers = model.content.range, LearnedNumbers(model)
    fastest = found.yaw_gain * max(map(abs, span.yaw_rate))
    turn = "[rad/s] of the body, as far as the log went, to the side where it went further"
    named = (
        ("linear.x.max_velocity", found.speed_gain * max(span.speed[1], 0.0), _SPEED),
        ("linear.x.min_velocity", found.speed_gain * min(span.speed[0], 0.0), _SPEED),
        ("angular.z.max_velocity", fastest, turn),
        ("angular.z.min_velocity", fastest * -1.0, turn),
    )
    return [stated((name,), number, meaning, numbers) for name, number, meaning in named]
