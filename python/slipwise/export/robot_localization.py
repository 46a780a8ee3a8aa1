# SPDX-License-Identifier: Apache-2.0
"""robot_localization's EKF: process noise from the slip noise, control gains and limits from the lag."""

from __future__ import annotations

from dataclasses import dataclass

from slipwise.export.actuator import ChannelResponse, actuator_of
from slipwise.export.body_limits import reached_text
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.measured_limits import MeasuredLimits, Quantity
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, for_release
from slipwise.export.reference_drive import (
    ReferenceDrive,
    learned_variances,
    reference_drive,
    slip_density,
)
from slipwise.export.ros_tables import ROBOT_LOCALIZATION
from slipwise.models.model import Model

#: The filter's own defaults of the process noise, [x, y, z, roll, pitch, yaw and their rates, ax, ay, az].
DEFAULTS = (0.05, 0.05, 0.06, 0.03, 0.03, 0.06, 0.025, 0.025, 0.04, 0.01, 0.01, 0.02, 0.01, 0.01, 0.015)
_X, _Y, _YAW = 0, 1, 5
UNCLIPPED = "the gain times the largest step of the log: clips nothing"


def robot_localization(model: Model, options: ExportOptions) -> ParameterFile:
    """Return the parameters of an ekf_filter_node that the model determines.

    Raises:
        ModelError: noise cannot be stated.
    """
    drive = reference_drive(model)
    from_commands = model.content.input == "command"
    entries = [
        Entry(
            ("frequency",),
            options.filter_rate,
            "[Hz] the filter's default is 30; the gains below stay below it",
            supposed=True,
        ),
        Entry(("two_d_mode",), True, "the model is planar", supposed=True),
        *_process_noise(model, drive, options.horizon),
        *(_control(model, options) if from_commands else [_WITHOUT_CONTROL]),
    ]
    return ParameterFile(
        node="ekf_filter_node",
        entries=for_release(entries, ROBOT_LOCALIZATION),
        notes=[
            "Names of robot_localization for ROS 2, all versions. Its sensors (odom0, imu0, ...) are yours.",
            _NOT_TWICE,
            "The filter reads these when it starts: restart it with this file.",
        ],
    )


_NOT_TWICE = """\
The slip noise stands in the process noise of x, y and yaw. If the odometry's twist covariance already holds
it (diff_drive_controller.yaml), use one of the two, or it counts twice."""
_WITHOUT_CONTROL = Entry(
    ("use_control",),
    False,
    "this model is from wheel speeds: it does not know how the robot answers commands",
    supposed=True,
)


def _process_noise(model: Model, drive: ReferenceDrive, horizon: float) -> list[Entry]:
    """Return the process noise: PSDs that the filter multiplies by the squared speed, and by time."""
    norm = drive.speed**2 + drive.yaw_rate**2
    lon, lat, yaw = learned_variances(
        model, lambda each: slip_density(each, (drive.speed, drive.yaw_rate), horizon) / norm
    )
    position = max(lon, lat, key=lambda number: number.value)
    numbers, diagonal, unknown = LearnedNumbers(model), list(DEFAULTS), []
    for places, number, name in (((_X, _Y), position, "x and y"), ((_YAW,), yaw, "yaw")):
        why = numbers.objection(number)
        if why:
            unknown.append(f"\n{name} too: {why}")
        for place in () if why else places:
            diagonal[place] = number.value
    size = len(diagonal)
    flat = [diagonal[i] if i == j else 0.0 for i in range(size) for j in range(size)]
    return [
        Entry(
            ("dynamic_process_noise_covariance",),
            True,
            "the filter scales pose noise by v^2 + w^2: none while parked",
        ),
        Entry(
            ("process_noise_covariance",),
            flat,
            f"x and y (the noisier of forward and sideways) and yaw: learned, right at {drive.speed:.3g}"
            f" m/s\nand {drive.yaw_rate:.3g} rad/s over {horizon:g} s. All others: the filter's defaults"
            + "".join(unknown),
        ),
    ]


@dataclass(frozen=True, eq=False)
class _Axis:
    """What the filter is to know of one commanded speed; `why` says why nothing, where that is so."""

    gain: float  # 1/s
    why: str = ""


def _axis(channel: ChannelResponse, numbers: LearnedNumbers, rate: float) -> _Axis:
    """Return the gain 1/lag, by which the filter multiplies the missing speed; at most its `rate` [Hz]."""
    lag = channel.mean_lag
    why = channel.objection or numbers.objection(lag) or channel.delay_objection(numbers)
    if not why and lag.value == 0.0:  # the model has none: how late the robot is must be known at least
        why = numbers.objection(channel.mean_delay)
    if why:
        return _Axis(0.0, why)
    quick = lag.value * rate <= 1.0
    return _Axis(rate if quick else 1.0 / lag.value)


def _control(model: Model, options: ExportOptions) -> list[Entry | Kept]:
    """Return the control term of the axes whose lag is known."""
    numbers, actuator = LearnedNumbers(model.body), actuator_of(model)
    v, omega = (_axis(channel, numbers, options.filter_rate) for channel in (actuator.v, actuator.omega))
    if v.why and omega.why:
        return [Kept(("use_control",), f"the lag of the speed: {v.why};\nthat of the yaw rate: {omega.why}")]
    gains = MeasuredLimits(model, numbers).gains
    delays = f"{numbers.text(actuator.v.delay)} s and {numbers.text(actuator.omega.delay)} s"
    unknown = [
        f"not the {name}: {axis.why}" for name, axis in (("speed", v), ("yaw rate", omega)) if axis.why
    ]
    return [
        Entry(
            ("use_control",),
            True,
            f"the filter has no delay; this robot's are {delays}. It takes commands\n"
            f"for reached; this robot, once settled, {reached_text(gains, numbers)}:\n"
            "correct that first, where commands become wheel speeds",
        ),
        _stamped(options.stamped_commands),
        Entry(
            ("control_config",),
            [not v.why, False, False, False, False, not omega.why],
            "\n".join(unknown) or "speed and yaw rate are commanded",
        ),
        Entry(
            ("acceleration_gains",),
            _on_axes(v.gain, omega.gain),
            "[1/s] one over the lag, at most the filter's frequency",
        ),
        Entry(("deceleration_gains",), _on_axes(v.gain, omega.gain), "[1/s] as above"),
        *_accelerations(model, numbers, (v, omega)),
    ]


def _stamped(stamped: bool | None) -> Entry | Kept:
    if stamped is None:
        return Kept(
            ("stamped_control",),
            "the filter reads no commands of the wrong type: add --stamped-commands or --no-stamped-commands",
        )
    return Entry(("stamped_control",), stamped, f"commands are {'TwistStamped' if stamped else 'Twist'}")


def _accelerations(model: Model, numbers: LearnedNumbers, axes: tuple[_Axis, _Axis]) -> list[Entry]:
    """Return how quickly the robot may follow in the filter: the drive's limit, or as its gains let it."""
    span, measured = model.content.range, MeasuredLimits(model, numbers)
    unclipped = [
        Quantity(numbers.exactly(axis.gain * abs(gain.value) * (max(high, 0.0) - min(low, 0.0))), UNCLIPPED)
        for axis, gain, (low, high) in zip(axes, measured.behind, (span.speed, span.yaw_rate), strict=True)
    ]
    found = {
        "acceleration_limits": (measured.acceleration(), measured.yaw_acceleration()),
        "deceleration_limits": (measured.braking(), measured.yaw_braking()),
    }
    entries: list[Entry] = []
    for name, learned in found.items():
        limits = [
            free if isinstance(limit, str) else limit for limit, free in zip(learned, unclipped, strict=True)
        ]
        v, omega = (0.0 if axis.why else limit.number.value for limit, axis in zip(limits, axes, strict=True))
        used = [limit.source for limit, axis in zip(limits, axes, strict=True) if not axis.why]
        sources = "; ".join(dict.fromkeys(used))
        entries.append(Entry((name,), _on_axes(v, omega), f"[m/s^2, rad/s^2] {sources}"))
    return entries


def _on_axes(v: float, omega: float) -> list[float]:
    return [v, 0.0, 0.0, 0.0, 0.0, omega]
