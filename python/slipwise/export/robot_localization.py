# SPDX-License-Identifier: Apache-2.0
"""robot_localization's EKF: process noise from the slip noise, control gains and limits from the lag."""

from __future__ import annotations

from slipwise.export.chain import chain_of
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, ParameterFile
from slipwise.export.reference_drive import ReferenceDrive, reference_drive, slip_density
from slipwise.models.model import Model

FREQUENCY = 30.0  # Hz, the filter's default
#: The filter's own defaults of the process noise, [x, y, z, roll, pitch, yaw and their rates, ax, ay, az].
DEFAULTS = (0.05, 0.05, 0.06, 0.03, 0.03, 0.06, 0.025, 0.025, 0.04, 0.01, 0.01, 0.02, 0.01, 0.01, 0.015)
_X, _Y, _YAW = 0, 1, 5


def robot_localization(model: Model, options: ExportOptions) -> ParameterFile:
    """Return the parameters of an ekf_filter_node that the model determines.

    Raises:
        ModelError: noise cannot be stated.
    """
    drive = reference_drive(model)
    from_commands = model.content.input == "command" and model.content.dynamics
    entries = [
        Entry(("frequency",), FREQUENCY, "[Hz] the filter's default; the gains below stay below it"),
        Entry(("two_d_mode",), True, "the model is planar"),
        *_process_noise(model, drive, options.horizon),
        *(_control(model) if from_commands else [Entry(("use_control",), False, _NO_CONTROL)]),
    ]
    return ParameterFile(
        node="ekf_filter_node",
        entries=entries,
        notes=[
            "Names of robot_localization for ROS 2, all versions. Its sensors (odom0, imu0, ...) are yours.",
            _NOT_TWICE,
        ],
    )


_NOT_TWICE = """\
The slip noise stands in the process noise of x, y and yaw. If the odometry's twist covariance already holds
it (diff_drive_controller.yaml), use one of the two, or it counts twice."""
_NO_CONTROL = "this model is from wheel speeds: it does not know how the robot answers commands"


def _process_noise(model: Model, drive: ReferenceDrive, horizon: float) -> list[Entry]:
    """Return the process noise: PSDs that the filter multiplies by the squared speed, and by time."""
    lon, lat, yaw = slip_density(model, (drive.speed, drive.yaw_rate), horizon).tolist()
    norm = drive.speed**2 + drive.yaw_rate**2
    diagonal = list(DEFAULTS)
    diagonal[_X] = diagonal[_Y] = max(lon, lat) / norm
    diagonal[_YAW] = yaw / norm
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
            f" m/s\nand {drive.yaw_rate:.3g} rad/s over {horizon:g} s. All others: the filter's defaults",
        ),
    ]


def _control(model: Model) -> list[Entry]:
    """Return gains 1/lag, by which the filter multiplies the missing speed, and limits that never bind."""
    chain, span = chain_of(model), model.content.range
    gains, limits = [], []
    for lag, (low, high) in ((chain.v.mean_lag, span.speed), (chain.omega.mean_lag, span.yaw_rate)):
        gain = min(1.0 / lag, FREQUENCY) if lag > 0.0 else FREQUENCY
        gains.append(gain)
        limits.append(gain * (max(high, 0.0) - min(low, 0.0)))
    axes = [_on_axes(values) for values in (gains, limits)]
    delays = f"{chain.v.delay:.3g} s and {chain.omega.delay:.3g} s"
    return [
        Entry(("use_control",), True, f"the filter has no delay; this robot's are {delays}"),
        Entry(
            ("control_config",), [True, False, False, False, False, True], "speed and yaw rate are commanded"
        ),
        Entry(("acceleration_gains",), axes[0], "[1/s] one over the lag, at most the filter's frequency"),
        Entry(("deceleration_gains",), axes[0], "[1/s] as above"),
        Entry(
            ("acceleration_limits",),
            axes[1],
            "[m/s^2, rad/s^2] what the lag does at the widest step of the log",
        ),
        Entry(("deceleration_limits",), axes[1], "[m/s^2, rad/s^2] as above"),
    ]


def _on_axes(values: list[float]) -> list[float]:
    return [values[0], 0.0, 0.0, 0.0, 0.0, values[1]]
