# SPDX-License-Identifier: Apache-2.0
"""Runs as the wheels tell them: the drive behind the commands, and the path the wheels alone would make."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import DriveRun, input_track
from slipwise.logs.log import Inputs, Poses


def has_wheels(drive: tuple[DriveRun, ...]) -> bool:
    """Whether every run has wheel speeds beside its commands."""
    return all(run.wheels is not None and len(run.wheels) > 1 for run in drive)


def wheel_runs(drive: tuple[DriveRun, ...]) -> tuple[DriveRun, ...]:
    """Return the same runs with the wheels as inputs: from them to the poses there is only slip."""
    return tuple(
        replace(run, inputs=_wheels(run), track=input_track(_wheels(run), rolling=True), wheels=None)
        for run in drive
    )


def chain_runs(drive: tuple[DriveRun, ...]) -> tuple[DriveRun, ...]:
    """Return the same runs with the wheels' own path for poses: from the commands to it there is no slip."""
    return tuple(replace(run, run=replace(run.run, poses=_dead_reckoned(_wheels(run)))) for run in drive)


def _wheels(run: DriveRun) -> Inputs:
    assert run.wheels is not None
    return run.wheels


def _dead_reckoned(wheels: Inputs) -> Poses:
    """Poses at the stamps of the wheel speeds, held between them."""
    plain = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    track = _core.InputTrack(wheels.t, wheels.v, wheels.vy, wheels.omega)
    origin = _core.Pose2(0.0, 0.0, 0.0)
    whole = _core.Segment(float(wheels.t[0]), float(wheels.t[-1]), origin, None, 0.0, 0.0)
    path = _core.integrate_segment(plain, np.zeros(0), track, whole, _core.Integrator.Exact)
    x, y, yaw = np.ascontiguousarray(path.poses.T)
    return Poses(t=wheels.t, x=x, y=y, yaw=yaw, frame=np.zeros(len(wheels), dtype=np.int64))
