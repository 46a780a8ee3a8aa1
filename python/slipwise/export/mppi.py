# SPDX-License-Identifier: Apache-2.0
"""Nav2's MPPI controller: how late the robot answers, how tightly it turns, and limits on request."""

from __future__ import annotations

from dataclasses import replace

from slipwise.errors import ModelError
from slipwise.export.actuator import Actuator, ChannelResponse
from slipwise.export.body_limits import Gains, reached_text, slip_gains
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.measured_limits import MeasuredLimits, Quantity
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, for_release, stated
from slipwise.export.ros_tables import MPPI, checked_distro, motion_model
from slipwise.models.body_gains import turning_twists
from slipwise.models.limits import LimitsSection
from slipwise.models.model import Model

LONGEST_DELAY = 0.25  # of the planning horizon; a longer one leaves the controller little to decide
_CONTROLLER = MPPI.prefix.rstrip(".")
_DEAD_BANDS = ("VelocityDeadbandCritic", "deadband_velocities")
_AS_COMMANDED = 0.02  # of a gain; a robot that is so close to it does what it is commanded
_SIDES = """\
Limits of the sides bound speed and turning together; here each is bounded as if the robot did only that.
Where it does both, keep below them by yourself."""


def mppi(model: Model, options: ExportOptions) -> ParameterFile:
    """Return the parameters of Nav2's MPPI controller that the model determines.

    Raises:
        ModelError: the model was learned from wheel speeds, which say nothing about commands, or no release
            of ROS is named.
    """
    if model.content.input != "command":
        raise ModelError(
            "MPPI plans commands, and this model was not learned from commands",
            advice="calibrate with `--input command`",
        )
    distro = checked_distro(options.ros_distro, "Nav2's MPPI")
    numbers, limits = LearnedNumbers(model.body), model.limits_section
    measured = MeasuredLimits(model, numbers)
    entries = [
        *_kind(distro, steers=model.steers or options.min_turning_radius is not None),
        *_delays(measured.actuator, numbers, options.planning_horizon),
        *(_limits(model, measured, numbers) if options.limits else ()),
        *_turning(model, options, numbers, distro),
        *dead_bands(limits, numbers),
    ]
    notes = [
        f"Names of Nav2 for ROS 2 {distro.capitalize()}.",
        _reached(measured.gains, numbers),
        *limit_notes(limits),
    ]
    return ParameterFile(
        node="controller_server",
        entries=for_release(
            [replace(entry, key=(_CONTROLLER, *entry.key)) for entry in entries], MPPI, distro
        ),
        notes=notes if options.limits else [*notes, _NO_LIMITS],
    )


_NO_LIMITS = """\
Limits of speeds and accelerations (vx_max, wz_max, az_max, ...) are left as they are: a log shows how the
robot was driven, not what it may do. `--limits` writes what the poses show."""


def _reached(gains: Gains, numbers: LearnedNumbers) -> str:
    """Say what MPPI supposes of commands, and how much of them the robot reaches."""
    return (
        "MPPI takes the robot to reach each command exactly. This one, once settled,\n"
        f"{reached_text(gains, numbers)}:\ncorrect that first,"
        " where commands become wheel speeds. Speeds below are of the body."
    )


def _kind(distro: str, *, steers: bool) -> list[Entry]:
    name, plugin = motion_model("ackermann" if steers else "diff-drive", distro)
    if not plugin:
        return [Entry(("motion_model",), name, "the kind of vehicle", supposed=True)]
    return [
        Entry(("motion_model",), name, "the plug-in below", supposed=True),
        Entry((name, "plugin"), plugin, "the kind of vehicle", supposed=True),
    ]


def _delays(actuator: Actuator, numbers: LearnedNumbers, horizon: float) -> list[Entry | Kept]:
    return [
        _delay(f"model_delay_{name}", channel, numbers, horizon)
        for name, channel in (("vx", actuator.v), ("wz", actuator.omega))
    ]


def _delay(name: str, channel: ChannelResponse, numbers: LearnedNumbers, horizon: float) -> Entry | Kept:
    late = channel.mean_delay
    why = channel.objection or channel.delay_objection(numbers)
    if why:
        return Kept((name,), why)
    if late.value > LONGEST_DELAY * horizon:
        return Kept(
            (name,),
            f"the robot answers {late.value:.3g} s late, more than a quarter of the {horizon:g} s that MPPI\n"
            "plans ahead (time_steps times model_dt, --planning-horizon): it would have no say left",
        )
    meaning = (
        f"[s] {numbers.text(late)}: delay {channel.delay.value:.3g} and lag {channel.mean_lag.value:.3g}."
        " MPPI has no lag, and a delay of\nthe same length loses the same distance"
    )
    return stated((name,), late, meaning, numbers)


def _limits(model: Model, measured: MeasuredLimits, numbers: LearnedNumbers) -> list[Entry | Kept]:
    """Return bounds of speeds as the poses show them, accelerations by the drive's limits or lateness."""
    actuator = measured.actuator
    v, omega = _ramps(model, actuator, numbers)
    found = {
        "vx_max": (measured.top_speed(), 1.0, "m/s"),
        "vx_min": (measured.top_speed_back(), -1.0, "m/s"),
        "wz_max": (measured.top_yaw_rate(), 1.0, "rad/s"),
        "ax_max": (measured.acceleration(*v), 1.0, "m/s^2"),
        "ax_min": (measured.braking(*v), -1.0, "m/s^2"),
        "az_max": (measured.yaw_acceleration(*omega), 1.0, "rad/s^2"),
    }
    objections = {
        "ax_max": actuator.v.objection,
        "ax_min": actuator.v.objection,
        "az_max": actuator.omega.objection,
    }
    gains = dict.fromkeys(found, measured.gains[0]) | dict.fromkeys(("wz_max", "az_max"), measured.gains[1])
    return [
        Kept((name,), objections.get(name) or limit)
        if isinstance(limit, str)
        else stated(
            (name,),
            limit.number * sign,
            f"[{unit}] {limit.source}{_as_command(limit.number * sign, gains[name], numbers)}",
            numbers,
        )
        for name, (limit, sign, unit) in found.items()
    ]


def _as_command(limit: LearnedNumber, gain: LearnedNumber, numbers: LearnedNumbers) -> str:
    """Say of which command a limit of the body is, while the robot does not do what it is commanded."""
    if numbers.objection(gain) or not limit.value or abs(gain.value - 1.0) < _AS_COMMANDED:
        return ""
    command = limit.value / gain.value
    return f";\na command of {command:.3g} gives it: write that where the drive is not corrected"


def _ramps(model: Model, actuator: Actuator, numbers: LearnedNumbers) -> list[list[Quantity]]:
    """Return the ramps to the fastest speed that lose as much way as the robot does by being late."""
    body = model.content.range.body
    ramps: list[list[Quantity]] = []
    for channel, name in ((actuator.v, "speed"), (actuator.omega, "yaw_rate")):
        late = channel.mean_delay
        fastest = 0.0 if body is None else max(map(abs, getattr(body, name)))
        if channel.objection or not late.value > 0.0 or not fastest > 0.0:
            ramps.append([])
            continue
        source = (
            f"the robot answers {late.value:.3g} s late, delay and lag together: a ramp of this slope to the"
            " fastest of the log loses as much way"
        )
        ramps.append([Quantity(numbers.exactly(fastest / 2.0) / late, source)])
    return ramps


def _turning(
    model: Model, options: ExportOptions, numbers: LearnedNumbers, distro: str
) -> list[Entry | Kept]:
    radius = options.min_turning_radius
    if radius is None:
        return []
    name, plugin = motion_model("ackermann", distro)
    key = (name,) if plugin else ("AckermannConstraints",)
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


def dead_bands(limits: LimitsSection | None, numbers: LearnedNumbers) -> list[Entry | Kept]:
    """Return the speeds below which commands give nothing; zero, Nav2's own, where none is known."""
    bands = () if limits is None else (limits.speed.dead_band, limits.yaw_rate.dead_band)
    known = [None if band is None else numbers.limit(band) for band in bands]
    objections = [numbers.objection(band) for band in known if band is not None]
    if not objections:
        return []
    if all(objections):
        return [Kept(_DEAD_BANDS, objections[0])]
    speed, turn = (0.0 if band is None or numbers.objection(band) else band.value for band in known)
    meaning = "[m/s, m/s, rad/s] commands that are slower give zero"
    return [Entry(_DEAD_BANDS, [speed, 0.0, turn], "\n".join((meaning, *filter(None, objections))))]


def limit_notes(limits: LimitsSection | None) -> list[str]:
    """Return what the file's reader must know of limits."""
    if limits is None:
        return ["The model has no dead-band: VelocityDeadbandCritic is left as it is."]
    notes = []
    if limits.speed.dead_band is None and limits.yaw_rate.dead_band is None:
        notes.append("No dead-band of commands was learned: VelocityDeadbandCritic is left as it is.")
    if any(value is not None for _, value in limits.side):
        notes.append(_SIDES)
    return notes
