# SPDX-License-Identifier: Apache-2.0
"""A robot whose actuator model, clocks, slip, noise and pose sensor are known, to be learned from its log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs, Poses, Run

Floats = NDArray[np.float64]
Pair = tuple[float, float]  # of the speed, of the yaw rate
Triple = tuple[float, float, float]

FINEST = 0.01  # s; the drive is taken as constant over less
NONE = _core.Basis("none", [], [], [])


@dataclass(frozen=True)
class KnownRobot:
    """What lies between commands and measured poses. It is simulated without the core's actuator model."""

    lag: Pair = (0.3, 0.3)  # s
    delay: Pair = (0.1, 0.1)  # s
    gain: Pair = (1.0, 1.0)  # drive over command
    slow_fraction: Pair = (0.0, 0.0)  # of the drive, that follows by the slow lag
    slow_time_constant: Pair = (2.0, 2.0)  # s
    basis: _core.Basis = NONE
    slip: tuple[float, ...] = ()  # parameters of the basis
    sensor: Triple = (0.0, 0.0, 0.0)  # x, y [m], yaw [rad] of the pose sensor in base_link
    wheels_late: float = 0.0  # s by which wheel speeds are stamped later than commands
    poses_late: float = 0.0  # s by which poses are stamped later than wheel speeds
    slip_psd: Triple = (1e-4, 1e-4, 1e-4)  # white slip while moving [m^2/s, m^2/s, rad^2/s]
    pose_std: Pair = (0.01, 0.005)  # m, rad
    wheel_std: Pair = (0.01, 0.01)  # m/s, rad/s
    rate: float = 20.0  # Hz of poses and wheel speeds


@dataclass(frozen=True, eq=False)
class _Drive:
    """The drive between knots, without slip."""

    knots: Floats  # [N + 1] s
    mean: Floats  # [N, 2] speed [m/s] and yaw rate [rad/s] over each interval
    reached: Floats  # [N + 1, 2] m and rad: their integrals


def known_run(robot: KnownRobot, commands: Inputs, span: Pair, *, random: np.random.Generator) -> Run:
    """Drive by the commands, which are zero before the first, and record the measurements within `span`.

    Times [s] are those of the commands. A wheel speed is the mean until the next: holding it is exact.

    Raises:
        SettingsError: the span has no time, or the commands go sideways.
    """
    if not span[1] > span[0] or np.any(commands.vy):
        raise SettingsError("a known robot needs a span of time and commands without a sideways part")
    seen = np.arange(span[0], span[1], 1.0 / robot.rate)
    drive = _drive(robot, commands, seen)
    poses = _poses(robot, drive, seen, random)
    at = np.searchsorted(drive.knots, seen - 1e-9)
    speeds = np.diff(drive.reached[at], axis=0) * robot.rate
    speeds = speeds + random.standard_normal(speeds.shape) * robot.wheel_std
    v, omega = np.ascontiguousarray(speeds.T)
    wheels = Inputs(t=seen[:-1] + robot.wheels_late, v=v, vy=np.zeros_like(v), omega=omega)
    return Run(name="known-robot", commands=commands, wheels=wheels, poses=poses)


def _drive(robot: KnownRobot, commands: Inputs, seen: Floats) -> _Drive:
    changes = [commands.t + delay for delay in robot.delay]
    begin, end = min(float(commands.t[0]), float(seen[0])), float(seen[-1])
    knots = np.concatenate((np.arange(begin, end, FINEST), seen, *changes))
    knots = np.unique(np.round(knots[(knots >= begin) & (knots <= end)], 9))
    mean = np.empty((len(knots) - 1, 2))
    for channel, commanded in enumerate((commands.v, commands.omega)):
        place = np.searchsorted(changes[channel], knots[:-1] + 1e-9) - 1
        u = robot.gain[channel] * np.where(place >= 0, commanded[np.maximum(place, 0)], 0.0)
        fraction = robot.slow_fraction[channel]
        fast = _lagged((1.0 - fraction) * u, np.diff(knots), robot.lag[channel])
        mean[:, channel] = fast + _lagged(fraction * u, np.diff(knots), robot.slow_time_constant[channel])
    reached = np.vstack((np.zeros(2), np.cumsum(mean * np.diff(knots)[:, None], axis=0)))
    return _Drive(knots, mean, reached)


def _lagged(u: Floats, duration: Floats, lag: float) -> Floats:
    """Mean over each interval [N] of a first-order lag from rest under inputs held over it."""
    keep = np.exp(-duration / lag)
    of_gap = lag * (1.0 - keep) / duration
    mean, now = np.empty_like(u), 0.0
    for i, (target, stay, part) in enumerate(zip(u.tolist(), keep.tolist(), of_gap.tolist(), strict=True)):
        mean[i] = target + (now - target) * part
        now = target + (now - target) * stay
    return mean


def _poses(robot: KnownRobot, drive: _Drive, seen: Floats, random: np.random.Generator) -> Poses:
    alpha, slip = np.array(robot.slip), np.zeros((len(drive.mean), 3))
    for row, (v, omega) in zip(slip, drive.mean.tolist() if len(alpha) else (), strict=False):
        row[:] = _core.slip_rate(robot.basis, alpha, _core.SlipState(v, omega, 0.0, 0.0))
    duration = np.diff(drive.knots)[:, None]
    moving = np.any(np.abs(drive.mean) > 1e-6, axis=1)[:, None]
    white = random.standard_normal(slip.shape) * np.sqrt(np.array(robot.slip_psd) / duration) * moving
    twist = np.column_stack((drive.mean[:, 0], np.zeros(len(slip)), drive.mean[:, 1])) + slip + white
    history = _core.InputHistory(drive.knots[:-1], *(np.ascontiguousarray(column) for column in twist.T))
    whole = _core.Segment(
        float(drive.knots[0]), float(drive.knots[-1]), _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0
    )
    plain = _core.MotionModel(NONE, False, False)
    path = _core.integrate_segment(plain, np.zeros(0), history, whole, _core.Integrator.Exact)
    body = np.asarray(path.poses)[np.searchsorted(path.times, seen - 1e-9)]
    x, y, yaw = robot.sensor
    c, s = np.cos(body[:, 2]), np.sin(body[:, 2])
    noise = random.standard_normal((3, len(seen)))
    yaw = body[:, 2] + yaw + robot.pose_std[1] * noise[2]
    return Poses(
        t=seen + robot.wheels_late + robot.poses_late,
        x=body[:, 0] + c * x - s * y + robot.pose_std[0] * noise[0],
        y=body[:, 1] + s * x + c * y + robot.pose_std[0] * noise[1],
        yaw=np.arctan2(np.sin(yaw), np.cos(yaw)),
        frame=np.zeros(len(seen), dtype=np.int64),
    )
