# SPDX-License-Identifier: Apache-2.0
"""Roll and pitch of the robot from those of its sensor: in radians, in one turn, put upright."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.logs.findings.finding import RefusedLogError
from slipwise.logs.findings.readings import TiltedSensor, TiltInDegrees
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Floats, Log, Poses, Run
from slipwise.logs.motion_windows import wrapped
from slipwise.number_text import ROUNDING

_ENOUGH = 20  # attitudes; with fewer nothing is said of their unit
_STEADY = 0.8  # mean length of the direction that is up: a robot that tilts by 37 deg about its mean
_SLOPE = 60.0  # [deg] no robot drives on a steeper one
_YAW_HOLDS = np.pi / 4  # [rad] of pitch; beyond it the yaw of a sensor is not the robot's


def was_measured(values: Floats | float) -> bool:
    """Return whether some angle [rad] or height [m] of a source is more than rounding, [...].

    A roll and a pitch of a quaternion are an attitude where both were measured: a robot that was put into
    space with a roll alone has a pitch of rounding errors.
    """
    if isinstance(values, float):  # each pose of a live node
        return abs(values) > ROUNDING
    return bool(np.nanmax(np.abs(values), initial=0.0) > ROUNDING)


def levelled(log: Log) -> Log:
    """Return the log with the attitudes of the robot, as the learner sees them on a robot.

    How the sensor is mounted is noted, and an attitude that no robot can have is left out and counted.

    Raises:
        LogError: angles look like degrees.
    """
    where = log.sources[0].path if log.sources else ""
    _check_radians(log, where)
    gate, tally = _core.AttitudeGate(), Tally()
    runs = tuple(_level(run, gate, tally) for run in log.runs)
    words = mounting_words(gate.mounting)
    log = replace(log, runs=runs, left_out=log.left_out + tally.result())
    return log.with_found(TiltedSensor.of(words)) if words else log


def mounting_words(mounting: _core.AttitudeMounting) -> str:
    """Say how the sensor of roll and pitch sits on the robot, and what is done; "" where it is level."""
    if mounting.kind == _core.MountingKind.Level:
        return ""
    roll, pitch = np.degrees([mounting.roll, mounting.pitch])
    attitude = f"roll and pitch are those of a sensor that is not mounted level (about {roll:.0f} deg of roll"
    if mounting.kind == _core.MountingKind.Rolled:
        return f"{attitude}): this is taken out, and its yaw is used"
    if abs(mounting.pitch) < _YAW_HOLDS:
        return f"{attitude}, {pitch:.0f} deg of pitch): its yaw is used, its roll and pitch are not"
    return (
        f"{attitude}, {pitch:.0f} deg of pitch): its roll and pitch are not used, and its yaw may not be the "
        "robot's; record the pose of base_link"
    )


def _check_radians(log: Log, where: str) -> None:
    known = [_known(run.poses) for run in log.runs]
    roll, pitch = np.concatenate([np.empty((2, 0)), *known], axis=1)
    if len(roll) < _ENOUGH:
        return
    up = np.array([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])
    in_degrees = np.abs(wrapped(np.concatenate([roll, pitch]), 360.0))
    if np.linalg.norm(up.mean(axis=1)) < _STEADY and float(np.quantile(in_degrees, 0.99)) < _SLOPE:
        largest = float(in_degrees.max())
        raise RefusedLogError(TiltInDegrees.of(largest), where)


def _known(poses: Poses) -> Floats:
    """Roll and pitch where both were measured, [2, N]."""
    if poses.roll is None or poses.pitch is None:
        return np.empty((2, 0))
    both = np.stack([poses.roll, poses.pitch])
    return both[:, np.isfinite(both).all(axis=0)]


def _level(run: Run, gate: _core.AttitudeGate, tally: Tally) -> Run:
    poses = run.poses
    if poses.roll is None or poses.pitch is None:
        return run
    measured = np.column_stack((poses.t, poses.roll, poses.pitch))
    known = np.flatnonzero(np.isfinite(measured).all(axis=1))
    robot = np.full((len(poses), 2), np.nan)
    for row in known.tolist():
        found = gate.level(*measured[row].tolist())
        robot[row] = (np.nan, np.nan) if found is None else found
    steep = known[np.isnan(robot[known, 0])]
    if len(steep):
        tally.add(
            "steep-attitude",
            "roll and pitch of a sensor that is not mounted level, or of no robot that drives",
            count=len(steep),
            where=run.place(float(poses.t[steep[0]])),
        )
    if np.isnan(robot).all():
        return replace(run, poses=replace(poses, roll=None, pitch=None))
    return replace(run, poses=replace(poses, roll=robot[:, 0], pitch=robot[:, 1]))
