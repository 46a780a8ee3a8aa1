# SPDX-License-Identifier: Apache-2.0
"""ros2_control's `diff_drive_controller`: multipliers, covariance diagonals and the range of speeds."""

from __future__ import annotations

from slipwise.errors import ModelError
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, ParameterFile
from slipwise.export.reference_drive import motion_covariance, reference_drive, slip_density
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
        entries=[*_geometry(found, options), *_covariances(model, options), *_limits(model, found)],
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


def _geometry(found: WheelMultipliers, options: ExportOptions) -> list[Entry]:
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
    radius = f"+- {found.radius_std:.2g}; {sides}"
    return [
        *separation,
        Entry(("wheel_separation_multiplier",), found.separation, f"+- {found.separation_std:.2g}"),
        Entry(("left_wheel_radius_multiplier",), found.left_radius, radius),
        Entry(("right_wheel_radius_multiplier",), found.right_radius, radius),
    ]


def _covariances(model: Model, options: ExportOptions) -> list[Entry]:
    drive = reference_drive(model)
    at, seconds = (drive.speed, drive.yaw_rate), options.horizon
    where = f"at {drive.speed:.3g} m/s and {drive.yaw_rate:.3g} rad/s"
    density = slip_density(model, at, seconds)
    x, y, yaw = motion_covariance(model, at, seconds).diagonal().tolist()
    vx, vy, vyaw = (density * PUBLISH_RATE).tolist()
    return [
        Entry(("publish_rate",), PUBLISH_RATE, "[Hz] the twist's covariance below is for this rate"),
        Entry(
            ("twist_covariance_diagonal",),
            [vx, vy, UNMEASURED, UNMEASURED, UNMEASURED, vyaw],
            f"[m^2/s^2, rad^2/s^2] {where}: the density of the slip noise times the rate, so that a\n"
            f"filter that takes every message as new is as unsure after {seconds:g} s as the model is",
        ),
        Entry(
            ("pose_covariance_diagonal",),
            [x, y, UNMEASURED, UNMEASURED, UNMEASURED, yaw],
            f"[m^2, rad^2] {where}: growth within {seconds:g} s. The controller never lets it grow,\n"
            "so fuse the twist, or the pose as differences, never the pose itself",
        ),
    ]


def _limits(model: Model, found: WheelMultipliers) -> list[Entry]:
    span = model.content.range
    fastest = found.yaw_gain * max(map(abs, span.yaw_rate))
    turn = "[rad/s] of the body, as far as the log went, to the side where it went further"
    return [
        Entry(("linear.x.max_velocity",), found.speed_gain * max(span.speed[1], 0.0), _SPEED),
        Entry(("linear.x.min_velocity",), found.speed_gain * min(span.speed[0], 0.0), _SPEED),
        Entry(("angular.z.max_velocity",), fastest, turn),
        Entry(("angular.z.min_velocity",), -fastest, turn),
    ]
