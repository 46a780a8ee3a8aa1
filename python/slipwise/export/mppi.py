# SPDX-License-Identifier: Apache-2.0
"""Nav2's MPPI controller: how late the robot answers, how fast it may go, and how tightly it turns."""

from __future__ import annotations

from slipwise.errors import ModelError
from slipwise.export.chain import Chain, chain_of
from slipwise.export.mppi_limits import dead_band_notes, with_limits
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, ParameterFile
from slipwise.models.body_gains import body_gains, body_twists, turning_twists
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
    if model.content.input != "command" or not model.content.dynamics:
        raise ModelError(
            "MPPI plans commands, and this model was not learned from commands",
            advice="calibrate with `--input command`",
        )
    chain = chain_of(model)
    slip = body_gains(body_twists(model))
    limits = model.content.limits
    behind = (1.0, 1.0) if limits is None else (limits.gain_v, limits.gain_omega)
    gains = (behind[0] * chain.v.gain * slip[0], behind[1] * chain.omega.gain * slip[1])
    lateness = _delays(chain) if options.nav2 == "rolling" else _accelerations(chain, model, gains)
    entries = [*_kind(options), *_speeds(model, gains), *lateness, *_turning(model, options)]
    entries = with_limits(entries, limits, gains)
    return ParameterFile(
        node="controller_server",
        entries=[Entry((CONTROLLER, *entry.key), entry.value, entry.meaning) for entry in entries],
        notes=[
            _NAMES[options.nav2],
            (
                "MPPI takes the robot to reach each command exactly. This one, once settled, reaches"
                f" {gains[0]:.3f} of the speed\nand {gains[1]:.3f} of the yaw rate: correct that first,"
                " where commands become wheel speeds. Speeds below are of the body."
            ),
            *dead_band_notes(limits),
        ],
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


def _speeds(model: Model, gains: tuple[float, float]) -> list[Entry]:
    span, (speed, yaw) = model.content.range, gains
    return [
        Entry(("vx_max",), speed * max(span.speed[1], 0.0), "[m/s] as far as the log went"),
        Entry(("vx_min",), speed * min(span.speed[0], 0.0), "[m/s] as far as the log went"),
        Entry(
            ("wz_max",),
            yaw * max(map(abs, span.yaw_rate)),
            "[rad/s] as far as the log went, to the side where it went further",
        ),
    ]


def _delays(chain: Chain) -> list[Entry]:
    return [
        Entry(
            (f"model_delay_{name}",),
            channel.mean_delay,
            f"[s] delay {channel.delay:.3g} and lag {channel.mean_lag:.3g}: MPPI has no lag, and a delay of\n"
            "the same length loses the same distance",
        )
        for name, channel in (("vx", chain.v), ("wz", chain.omega))
    ]


def _accelerations(chain: Chain, model: Model, gains: tuple[float, float]) -> list[Entry]:
    """Return the ramps to the fastest speed that lose as much distance as the robot does by being late."""
    span = model.content.range
    late_v, late_omega = chain.v.mean_delay, chain.omega.mean_delay
    if not (late_v > 0.0 and late_omega > 0.0):
        return []
    ax = gains[0] * max(map(abs, span.speed)) / (2.0 * late_v)
    az = gains[1] * max(map(abs, span.yaw_rate)) / (2.0 * late_omega)

    def meaning(unit: str, late: float) -> str:
        return (
            f"[{unit}] the robot answers {late:.3g} s late, delay and lag together. A ramp of this slope\n"
            "to the fastest of the log loses as much way"
        )

    return [
        Entry(("ax_max",), ax, meaning("m/s^2", late_v)),
        Entry(("ax_min",), -ax, "[m/s^2] as ax_max"),
        Entry(("az_max",), az, meaning("rad/s^2", late_omega)),
    ]


def _turning(model: Model, options: ExportOptions) -> list[Entry]:
    radius = options.min_turning_radius
    if radius is None:
        return []
    key = ("AckermannConstraints",) if options.nav2 == "kilted" else ("ackermann",)
    speed, yaw_rate = body_gains(turning_twists(model, radius))
    if not (yaw_rate > 0.0 and speed > 0.0):
        raise ModelError(
            "by the model the vehicle does not turn the way it is steered",
            advice="check the signs of the log",
        )
    return [
        Entry(
            (*key, "min_turning_r"),
            radius * speed / yaw_rate,
            f"[m] {radius:g} by the vehicle's geometry, with the slip of full lock",
        )
    ]
