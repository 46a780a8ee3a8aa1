# SPDX-License-Identifier: Apache-2.0
"""Nav2's MPPI controller: how late the robot answers, how fast it may go, and how tightly it turns."""

from __future__ import annotations

from dataclasses import replace

from slipwise.errors import ModelError
from slipwise.export.actuator import Actuator, actuator_of
from slipwise.export.body_limits import Gains, body_limits, slip_gains
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.mppi_limits import Bound, dead_bands, limit_notes, with_limits
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, stated
from slipwise.models.body_gains import body_twists, turning_twists
from slipwise.models.model import Model

CONTROLLER = "FollowPath"  # the name that Nav2's own parameter file gives the controller
_NAMES = {
    "rolling": "Names of Nav2's main branch since June 2026 (ROS 2 Rolling, pull request 6154): MPPI with\n"
    "model_delay_* and motion models as plug-ins. For older releases export with `--nav2 kilted`.",
    "kilted": "Names of Nav2 for ROS 2 Kilted and Jazzy: MPPI without model_delay_*.\n"
    "For newer ones export with `--nav2 rolling`.",
}


def mppi(model: Model, options: ExportOptions) -> ParameterFile:
    """Return the parameters of Nav2's MPPI controller that the model determines.

    Raises:
        ModelError: the model was learned from wheel speeds, which say nothing about commands.
    """
    if model.content.input != "command":
        raise ModelError(
            "MPPI plans commands, and this model was not learned from commands",
            advice="calibrate with `--input command`",
        )
    numbers, actuator, limits = LearnedNumbers(model.body), actuator_of(model), model.content.limits
    slip = slip_gains(numbers, body_twists(model))
    behind = (actuator.v.gain * slip[0], actuator.omega.gain * slip[1])
    before = (1.0, 1.0) if limits is None else (limits.gain_v, limits.gain_omega)
    gains = (behind[0] * before[0], behind[1] * before[1])
    bounds = _speeds(model, gains)
    if options.nav2 == "kilted":
        bounds |= _accelerations(actuator, model, gains)
    entries = [
        *_kind(options),
        *(_delays(actuator, numbers) if options.nav2 == "rolling" else ()),
        *with_limits(bounds, body_limits(limits, behind, numbers), numbers),
        *_turning(model, options, numbers),
        *dead_bands(limits, numbers),
    ]
    return ParameterFile(
        node="controller_server",
        entries=[replace(entry, key=(CONTROLLER, *entry.key)) for entry in entries],
        notes=[_NAMES[options.nav2], _reached(gains, numbers), *limit_notes(limits)],
    )


def _reached(gains: Gains, numbers: LearnedNumbers) -> str:
    """Say how much of a command the robot reaches."""
    speed, yaw = (
        f"an unknown part of the {what}"
        if numbers.objection(gain)
        else f"{gain.value:.3f} of the {what} (+- {numbers.std(gain):.2g})"
        for gain, what in zip(gains, ("speed", "yaw rate"), strict=True)
    )
    return (
        f"MPPI takes the robot to reach each command exactly. This one, once settled,\nreaches {speed}"
        f" and {yaw}:\ncorrect that first,"
        " where commands become wheel speeds. Speeds below are of the body."
    )


def _kind(options: ExportOptions) -> list[Entry]:
    ackermann = options.min_turning_radius is not None
    if options.nav2 == "kilted":
        return [Entry(("motion_model",), "Ackermann" if ackermann else "DiffDrive", "the kind of vehicle")]
    name, plugin = ("ackermann", "Ackermann") if ackermann else ("diff_drive", "DiffDrive")
    return [
        Entry(("motion_model",), name, "the plug-in below"),
        Entry((name, "plugin"), f"mppi::{plugin}MotionModel", "the kind of vehicle"),
    ]


def _speeds(model: Model, gains: Gains) -> dict[str, list[Bound]]:
    span, (speed, yaw) = model.content.range, gains
    forth, back = speed * max(span.speed[1], 0.0), speed * min(span.speed[0], 0.0)
    turn = "[rad/s] as far as the log went, to the side where it went further"
    return {
        "vx_max": [Bound(forth, "[m/s] as far as the log went")],
        "vx_min": [Bound(back, "[m/s] as far as the log went")],
        "wz_max": [Bound(yaw * max(map(abs, span.yaw_rate)), turn)],
    }


def _delays(actuator: Actuator, numbers: LearnedNumbers) -> list[Entry | Kept]:
    return [
        stated(
            (f"model_delay_{name}",),
            channel.mean_delay,
            f"[s] {numbers.text(channel.mean_delay)}: delay {channel.delay.value:.3g} and lag"
            f" {channel.mean_lag.value:.3g}. MPPI has no lag, and a delay of\n"
            "the same length loses the same distance",
            numbers,
        )
        for name, channel in (("vx", actuator.v), ("wz", actuator.omega))
    ]


def _accelerations(actuator: Actuator, model: Model, gains: Gains) -> dict[str, list[Bound]]:
    """Return the ramps to the fastest speed that lose as much distance as the robot does by being late."""
    span = model.content.range
    late_v, late_omega = actuator.v.mean_delay, actuator.omega.mean_delay
    if not (late_v.value > 0.0 and late_omega.value > 0.0):
        return {}
    ax = gains[0] * (max(map(abs, span.speed)) / 2.0) / late_v
    az = gains[1] * (max(map(abs, span.yaw_rate)) / 2.0) / late_omega

    def meaning(unit: str, late: float) -> str:
        return (
            f"[{unit}] the robot answers {late:.3g} s late, delay and lag together. A ramp of this slope\n"
            "to the fastest of the log loses as much way"
        )

    return {
        "ax_max": [Bound(ax, meaning("m/s^2", late_v.value))],
        "ax_min": [Bound(ax * -1.0, "[m/s^2] as a ramp, like ax_max")],
        "az_max": [Bound(az, meaning("rad/s^2", late_omega.value))],
    }


def _turning(model: Model, options: ExportOptions, numbers: LearnedNumbers) -> list[Entry | Kept]:
    radius = options.min_turning_radius
    if radius is None:
        return []
    key = ("AckermannConstraints",) if options.nav2 == "kilted" else ("ackermann",)
    speed, yaw_rate = slip_gains(numbers, turning_twists(model, radius))
    if not (yaw_rate.value > 0.0 and speed.value > 0.0):
        raise ModelError(
            "by the model the vehicle does not turn the way it is steered",
            advice="check the signs of the log",
        )
    return [
        stated(
            (*key, "min_turning_r"),
            speed * radius / yaw_rate,
            f"[m] {radius:g} by the vehicle's geometry, with the slip of full lock",
            numbers,
        )
    ]
