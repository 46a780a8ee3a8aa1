# SPDX-License-Identifier: Apache-2.0
"""What a user knows to be wrong in a log is put right: scales and signs of inputs, the heading of poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.errors import SettingsError
from slipwise.logs.log import Floats, Inputs, Log, Poses
from slipwise.logs.motion_windows import wrapped
from slipwise.logs.options import LogOptions, RobotOptions

_AS_IT_IS = (1.0, 1.0)

OneAttitude = tuple[float, float | None, float | None]  # yaw, roll and pitch [rad]


def scaled_inputs(log: Log, options: LogOptions) -> Log:
    """Return the log with the scales of the options applied to its inputs; each is noted."""
    given = (("commands", options.command_scale), ("wheels", options.wheel_scale))
    notes = [
        f"{name}: speed times {factors[0]:g}, yaw rate times {factors[1]:g}, as given"
        for name, factors in given
        if factors != _AS_IT_IS
    ]
    if not notes:
        return log
    runs = tuple(
        replace(
            run,
            commands=_scaled(run.commands, options.command_scale),
            wheels=_scaled(run.wheels, options.wheel_scale),
        )
        for run in log.runs
    )
    kinds = {"command": options.command_scale, "wheel": options.wheel_scale}
    scales = {kind: factors for kind, factors in kinds.items() if factors != _AS_IT_IS}
    return replace(log, runs=runs, notes=(*log.notes, *notes), scales=scales)


def turned_poses(log: Log, options: LogOptions) -> Log:
    """Return the log with its poses turned as the options say, which is noted.

    Raises:
        SettingsError: only positions were measured; settings of a robot may turn headings of its other logs.
    """
    offset = options.pose_yaw_offset
    if offset == 0.0:
        return log
    if all(poses.course for run in log.runs for poses in (run.poses, *run.others.values())):
        if isinstance(options, RobotOptions):
            return log
        what = "only positions were measured, which have no heading to turn"
        raise SettingsError(what, where="--pose-yaw-offset", advice="leave it away")
    runs = tuple(run.with_each_source(lambda poses: _turned(poses, offset)) for run in log.runs)
    return replace(
        log, runs=runs, notes=(*log.notes, f"poses: {offset:.6g} rad added to every heading, as given")
    )


def _scaled(inputs: Inputs | None, factors: tuple[float, float]) -> Inputs | None:
    if inputs is None or factors == _AS_IT_IS:
        return inputs
    speed, yaw_rate = factors
    return replace(inputs, v=inputs.v * speed, vy=inputs.vy * speed, omega=inputs.omega * yaw_rate)


def _turned(poses: Poses, offset: float) -> Poses:
    """Poses of the robot from those of a sensor that is turned on it; roll and pitch are turned with it."""
    yaw, roll, pitch = turned((poses.yaw, poses.roll, poses.pitch), offset)
    return replace(poses, yaw=yaw, roll=roll, pitch=pitch)


def turned(
    angles: tuple[Floats, Floats | None, Floats | None], offset: float
) -> tuple[Floats, Floats | None, Floats | None]:
    """Return yaw, roll and pitch [rad] of the robot from those of a sensor that is turned on it."""
    yaw, roll, pitch = angles
    if offset == 0.0:
        return angles
    yaw = wrapped(yaw + offset)
    if roll is None or pitch is None:
        return yaw, roll, pitch
    down_x, down_y = np.sin(pitch), -np.cos(pitch) * np.sin(roll)
    turned_x = np.cos(offset) * down_x + np.sin(offset) * down_y
    turned_y = np.cos(offset) * down_y - np.sin(offset) * down_x
    roll = np.arctan2(-turned_y, np.cos(pitch) * np.cos(roll))
    return yaw, roll, np.arcsin(np.clip(turned_x, -1.0, 1.0))


def turned_one(angles: OneAttitude, offset: float) -> OneAttitude:
    """Return `turned` of one pose; its roll and pitch are known together, or neither."""
    yaw, roll, pitch = angles
    if roll is None or pitch is None:
        roll = pitch = None
    if offset == 0.0:
        return yaw, roll, pitch
    made = turned((np.array([yaw]), _row(roll), _row(pitch)), offset)
    return float(made[0][0]), _number(made[1]), _number(made[2])


def _row(angle: float | None) -> Floats | None:
    return None if angle is None else np.array([angle])


def _number(row: Floats | None) -> float | None:
    return None if row is None else float(row[0])


def late_by(options: LogOptions) -> float:
    """Return what is added to the stamps of poses that come live [s].

    Raises:
        SettingsError: it is to be found, which takes a whole log.
    """
    late = options.pose_clock_offset
    if isinstance(late, str):
        raise SettingsError(
            f"--pose-clock-offset {late} is found from a whole log, not live", advice="give the seconds"
        )
    return late or 0.0
