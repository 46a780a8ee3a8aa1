# SPDX-License-Identifier: Apache-2.0
"""A robot whose truth is known: a drive with delay, lag and limits, slip linear in stated terms, exact steps.

It shares nothing with slipwise but units and signs, so that what slipwise says can be held against it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP = 0.005  # s between the drive's steps; what it does is held over one
GRAVITY = 9.80665  # m/s^2
CHANNELS = ("lon", "lat", "ang")


@dataclass(frozen=True)
class Axis:
    """What lies between one number of a command and what the drive does."""

    delay: float = 0.0  # s
    lag: float = 0.0  # s, time constant
    dead_band: float = 0.0  # what is smaller gives zero, the rest passes as it is
    saturation: float = math.inf
    slew: float = math.inf  # of the change in a second

    def answer(self, told: Floats) -> Floats:
        """Return what the drive does in each step, of what it is told in each, from rest."""
        given = np.where(np.abs(told) < self.dead_band, 0.0, np.clip(told, -self.saturation, self.saturation))
        if math.isfinite(self.slew):
            given = _ramped(given, self.slew * STEP)
        late = round(self.delay / STEP)
        given = np.concatenate((np.zeros(late), given))[: len(given)]
        return given if self.lag == 0.0 else _lagged(given, math.exp(-STEP / self.lag), self.lag)


@dataclass(frozen=True)
class Robot:
    """A robot: its drive, how the drive moves it, and what slips or pushes."""

    axes: tuple[Axis, ...] = (Axis(), Axis())
    kind: str = "twist"  # of a command: (v, omega) or (v, vy, omega); or "steering" (v, angle), or "throttle"
    wheelbase: float = 0.5  # m, of a car that steers
    speeds: tuple[tuple[float, ...], tuple[float, ...]] = ((-1.0, 1.0), (-3.0, 3.0))  # of throttles, m/s
    curvatures: tuple[tuple[float, ...], tuple[float, ...]] = ((-1.0, 1.0), (-1.5, 1.5))  # of steerings, 1/m
    slip: Mapping[str, float] = field(default_factory=dict)  # of products of V, Vy, w, abs(V), gx, gy
    slope: float = 0.0  # rad, of the plane that it drives on; downhill is the world's -x
    wind: tuple[float, float] = (0.0, 0.0)  # m/m pushed per distance driven, along x and y of the world
    force: tuple[float, float] = (
        0.0,
        math.inf,
    )  # m/s^2, amplitude and period [s] of a known push to its left

    def asked(self, told: Floats) -> Floats:
        """Return what the drive is asked for by commands [N, axes]: what throttle and steering hold."""
        if self.kind != "throttle":
            return told
        return np.column_stack((np.interp(told[:, 0], *self.speeds), np.interp(told[:, 1], *self.curvatures)))

    def rows(self, told: Floats) -> Floats:
        """Return a command's numbers as slipwise takes them of such a robot: a car's turns as yaw rates."""
        if self.kind != "steering":
            return told
        return np.column_stack((told[:, 0], told[:, 0] * np.tan(told[:, 1]) / self.wheelbase))

    def commands(self, rows: Floats) -> Floats:
        """Return what slipwise gives as such numbers [N, axes] as the command of such a robot."""
        if self.kind != "steering":
            return rows
        turn = rows[:, 1] / np.where(np.abs(rows[:, 0]) < 1e-3, np.inf, rows[:, 0])
        return np.column_stack((rows[:, 0], np.arctan(turn * self.wheelbase)))


@dataclass(frozen=True, eq=False)
class Driven:
    """What a robot did, at each step."""

    t: Floats  # [N] s
    told: Floats  # [N, axes] the command in force
    wheels: Floats  # [N, 3] v, vy, omega that the wheels do, held until the next step
    moved: Floats  # [N, 3] the same of the body, with slip
    pose: Floats  # [N, 3] x, y, yaw on the plane
    push: Floats  # [N] m/s^2, the known force to its left

    def at(self, t: Floats) -> NDArray[np.int64]:
        """Return the steps at stamps."""
        return np.minimum(np.round(np.asarray(t) / STEP).astype(np.int64), len(self.t) - 1)

    def mean_wheels(self, t: Floats) -> Floats:
        """Return the mean twist of the wheels over the time nearest to each stamp, [N, 3]."""
        reached = np.vstack((np.zeros(3), np.cumsum(self.wheels, axis=0)))
        amid = self.at(t[:-1] + 0.5 * np.diff(t))
        first, last = np.insert(amid, 0, self.at(t[0])), np.append(amid, self.at(t[-1]) + 1)
        return (reached[last] - reached[first]) / np.maximum(last - first, 1)[:, None]


def drive(robot: Robot, t: Floats, commands: Floats, seconds: float, yaw: float = 0.0) -> Driven:
    """Drive from rest at the origin under commands [N, axes], each held from its stamp on."""
    steps = np.arange(round(seconds / STEP) + 1) * STEP
    at = np.searchsorted(t, steps + 1e-9, side="right") - 1
    told = np.where((at >= 0)[:, None], commands[np.maximum(at, 0)], 0.0)
    done = np.column_stack(
        [axis.answer(column) for axis, column in zip(robot.axes, robot.asked(told).T, strict=True)]
    )
    wheels = _twist(robot, done)
    amplitude, period = robot.force
    push = amplitude * np.cos(2.0 * np.pi * steps / period)
    v, vy, omega = wheels.T
    turning = omega + slip_of(robot.slip, "ang", v, vy, omega, (0.0, 0.0))
    heading = yaw + np.concatenate(([0.0], np.cumsum(turning[:-1]) * STEP))
    mid = heading + 0.5 * turning * STEP
    down = GRAVITY * math.sin(robot.slope)
    gravity = (-down * np.cos(mid), down * np.sin(mid) + push)
    ahead = v + slip_of(robot.slip, "lon", v, vy, omega, gravity)
    left = vy + slip_of(robot.slip, "lat", v, vy, omega, gravity)
    blown, c, s = np.abs(v), np.cos(mid), np.sin(mid)
    ahead = ahead + blown * (robot.wind[0] * c + robot.wind[1] * s)
    left = left + blown * (robot.wind[1] * c - robot.wind[0] * s)
    chord = STEP * np.sinc(0.5 * turning * STEP / np.pi)  # of an arc, in the direction of its middle
    steps_xy = np.column_stack((c * ahead - s * left, s * ahead + c * left)) * chord[:, None]
    place = np.vstack((np.zeros(2), np.cumsum(steps_xy[:-1], axis=0)))
    moved = np.column_stack((ahead, left, turning))
    return Driven(steps, told, wheels, moved, np.column_stack((place, heading)), push)


def slip_of(
    slip: Mapping[str, float], channel: str, v: Floats, vy: Floats, w: Floats, pull: tuple[object, object]
) -> Floats:
    """Return the slip of one channel: the sum of its terms times their numbers."""
    values = {
        "V": v,
        "Vy": vy,
        "w": w,
        "abs(V)": np.abs(v),
        "abs(w)": np.abs(w),
        "gx": pull[0],
        "gy": pull[1],
    }
    total = np.zeros_like(v)
    for name, number in slip.items():
        own, term = name.split(".")
        if own == channel:
            product = np.full_like(v, number)
            for factor in term.split("*"):
                product = product * values[factor]
            total = total + product
    return total


def in_space(robot: Robot, pose: Floats) -> Floats:
    """Return poses on the plane as x, y, z, roll, pitch, yaw; the z axis is vertical, [N, 6]."""
    c, s = math.cos(robot.slope), math.sin(robot.slope)
    x, y, turn = pose.T
    ahead = np.column_stack((c * np.cos(turn), np.sin(turn), s * np.cos(turn)))
    left = np.column_stack((-c * np.sin(turn), np.cos(turn), -s * np.sin(turn)))
    pitch = -np.arcsin(ahead[:, 2])
    roll = np.arctan2(left[:, 2], np.full(len(turn), c))
    return np.column_stack((c * x, y, s * x, roll, pitch, np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))))


def seen_from_start(poses: Floats) -> Floats:
    """Return poses [N, 3] in the frame of the first."""
    x, y, yaw = (poses - poses[0]).T
    c, s = math.cos(poses[0, 2]), math.sin(poses[0, 2])
    return np.column_stack((c * x + s * y, c * y - s * x, yaw))


def held_commands(
    ranges: tuple[tuple[float, float], ...], seconds: float, seed: int, hold: tuple[float, float] = (0.8, 2.4)
) -> Floats:
    """Return random commands at 20 Hz, each held for a while, with standing at the start and now and then."""
    rng = np.random.default_rng(seed)
    count = round(seconds / 0.05)
    commands = np.zeros((count, len(ranges)))
    begin, since = 20, 0
    while begin < count:
        end = begin + round(rng.uniform(*hold) / 0.05)
        since += 1
        stands = since % 8 == 0
        commands[begin:end] = 0.0 if stands else [rng.uniform(*each) for each in ranges]
        begin = end
    return np.round(commands, 6)


def _twist(robot: Robot, done: Floats) -> Floats:
    if robot.kind == "twist":
        side = done[:, 1] if done.shape[1] == 3 else np.zeros(len(done))
        return np.column_stack((done[:, 0], side, done[:, -1]))
    if robot.kind == "steering":
        v, turn = done[:, 0], np.tan(done[:, 1]) / robot.wheelbase
    else:
        v, turn = done[:, 0], done[:, 1]
    return np.column_stack((v, np.zeros(len(v)), v * turn))


def _lagged(given: Floats, keep: float, lag: float) -> Floats:
    """Mean over each step of a first-order lag from rest."""
    part, now = lag * (1.0 - keep) / STEP, 0.0
    out = np.empty_like(given)
    for i, target in enumerate(given.tolist()):
        out[i] = target + (now - target) * part
        now = target + (now - target) * keep
    return out


def _ramped(given: Floats, most: float) -> Floats:
    out, now = np.empty_like(given), 0.0
    for i, target in enumerate(given.tolist()):
        now += min(max(target - now, -most), most)
        out[i] = now
    return out
