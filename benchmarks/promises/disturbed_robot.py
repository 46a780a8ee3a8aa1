# SPDX-License-Identifier: Apache-2.0
"""A robot with known slip and actuators, whose slip is disturbed by noise and may change with the terrain.

It is commanded random speeds and yaw rates for 1 to 4 s each, 20 times a second; its actuators follow after
a delay with a first-order lag, behind limits where it has any: nothing moves in the dead band, nothing is
faster than the saturation, and what is asked for changes no faster than the slew rates. Slip rates
are those of `BASIS`, and noise: white, of a density that grows with the motion, or first-order Gauss-Markov
fractions of v and omega with a correlation time of 5 s, or both. White noise is normal or, where asked,
Student distributed and constant for 0.1 s. Poses and wheel speeds come 20 times a second, with normal noise;
stamps of poses may be off by a constant. From a moment on, yaw slip may be another than before.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs import Inputs, Log, Poses, Run

Floats = NDArray[np.float64]

STEP, RATE = 0.01, 20.0  # s of the simulation; Hz of all that is logged
TAIL_SECONDS = 0.1  # s for which Student distributed slip stays as it was drawn
BASIS = _core.Basis("true", ["V", "V*abs(w)"], ["V*w", "w"], ["w", "V"])
SLIP = np.array([-0.05, -0.03, 0.06, 0.01, -0.3, 0.02])
SLIP_STD = np.array([0.03, 0.02, 0.03, 0.01, 0.1, 0.02])  # from robot to robot


@dataclass(frozen=True)
class Disturbance:
    """What slip rates are besides those of the basis."""

    white: float = 1.0  # factor of WHITE
    slow: float = 0.0  # factor of SLOW
    degrees: float | None = None  # of freedom of a Student t that white slip has; None: normal


@dataclass(frozen=True)
class Limits:
    """Of the speed or the yaw rate of an actuator, in m/s and m/s^2 or rad/s and rad/s^2."""

    dead_band: float = 0.0
    saturation: float = np.inf
    slew_rate_up: float = np.inf
    slew_rate_down: float = np.inf


@dataclass(frozen=True)
class Robot:
    """What does not change from robot to robot."""

    delay: tuple[float, float] = (0.1, 0.08)  # s, of speed and yaw rate
    lag: tuple[float, float] = (0.2, 0.15)  # s
    limits: tuple[Limits, Limits] = (Limits(), Limits())  # of speed and yaw rate
    pose_std: tuple[float, float] = (0.01, 0.004)  # m, rad
    wheel_std: float = 0.003  # m/s and rad/s
    white: tuple[float, float, float] = (1e-3, 5e-4, 2e-3)  # density of slip [m, m, rad^2/m] of motion
    slow: tuple[float, float, float, float] = (0.05, 0.05, 0.15, 0.02)  # lon/V, lat/V, ang/w, ang/V
    correlation_time: float = 5.0  # s
    clock_offset: float = 0.0  # s by which poses are stamped too late
    disturbance: Disturbance = field(default_factory=Disturbance)


@dataclass(frozen=True)
class TerrainChange:
    """From `at` on, yaw slip is `factor` times that of before."""

    at: float  # s
    factor: float


@dataclass(frozen=True, eq=False)
class DisturbedRun:
    """A log, and the slip parameters that it was made with."""

    log: Log
    slip: Floats

    def rates(self, v: float, omega: float) -> Floats:
        """Return the true mean slip rates (m/s, m/s, rad/s)."""
        return np.asarray(_core.slip_rate(BASIS, self.slip, _core.SlipState(v, omega, 0.0, 0.0)))


def disturbed_run(
    robot: Robot, minutes: float, *, seed: int, change: TerrainChange | None = None
) -> DisturbedRun:
    """Simulate one robot whose slip parameters are drawn by the seed; `slip` is that before any change."""
    random = np.random.default_rng([seed, 18])
    slip = SLIP + SLIP_STD * random.standard_normal(len(SLIP))
    commands = _commands(minutes * 60.0, random)
    t = np.arange(0.0, commands.t[-1] + STEP / 2, STEP)
    v, omega = (_followed(robot, commands, channel, t) for channel in (0, 1))
    twist = np.column_stack((v, np.zeros_like(v), omega)) + _slip_rates(robot, slip, (v, omega), random)
    if change is not None:
        more = np.where(t >= change.at, change.factor - 1.0, 0.0)
        twist[:, 2] += more * (slip[4] * omega + slip[5] * v)
    every = round(1.0 / (STEP * RATE))
    whole = len(t) // every * every
    means = [channel[:whole].reshape(-1, every).mean(axis=1) for channel in (v, omega)]
    noise = robot.wheel_std * random.standard_normal((2, len(means[0])))
    wheels = Inputs(
        t=t[:whole:every], v=means[0] + noise[0], vy=np.zeros(len(means[0])), omega=means[1] + noise[1]
    )
    poses = _poses(robot, twist, t, random)
    return DisturbedRun(Log((Run(name="disturbed", commands=commands, wheels=wheels, poses=poses),)), slip)


def _commands(seconds: float, random: np.random.Generator) -> Inputs:
    t = np.round(np.arange(0.0, seconds, 1.0 / RATE), 6)
    count = int(seconds) + 2
    at = np.searchsorted(np.cumsum(random.uniform(1.0, 4.0, count)), t, side="right")
    v = random.uniform(0.3, 1.5, count) * random.choice((1.0, 1.0, 1.0, -1.0), count)
    omega = random.uniform(-0.8, 0.8, count)
    stop = random.random(count) < 0.05
    v[stop] = omega[stop] = 0.0
    return Inputs(t=t, v=v[at], vy=np.zeros(len(t)), omega=omega[at])


def _followed(robot: Robot, commands: Inputs, channel: int, t: Floats) -> Floats:
    """Speed or yaw rate at times `t`, from rest."""
    from scipy.signal import lfilter  # type: ignore[import-untyped]

    at = np.searchsorted(commands.t, t - robot.delay[channel] + 1e-9, side="right") - 1
    wish = np.where(at >= 0, (commands.v, commands.omega)[channel][np.maximum(at, 0)], 0.0)
    wish = _limited(wish, robot.limits[channel])
    keep = np.exp(-STEP / robot.lag[channel])
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], wish))


def _limited(wish: Floats, limits: Limits) -> Floats:
    """What is let through of a speed that is asked for, step by step, from rest."""
    clipped = np.where(
        np.abs(wish) < limits.dead_band, 0.0, np.clip(wish, -limits.saturation, limits.saturation)
    )
    if not np.isfinite(min(limits.slew_rate_up, limits.slew_rate_down)):
        return np.asarray(clipped)
    now, passed = 0.0, np.empty_like(clipped)
    for i, target in enumerate(clipped.tolist()):
        slower = now * target <= 0.0 or abs(target) < abs(now)
        most = STEP * (limits.slew_rate_down if slower and now != 0.0 else limits.slew_rate_up)
        change = min(max(target - now, -most), most)
        now = 0.0 if now * (now + change) < 0.0 else now + change  # through rest, then the other way
        passed[i] = now
    return passed


def _slip_rates(
    robot: Robot, slip: Floats, speeds: tuple[Floats, Floats], random: np.random.Generator
) -> Floats:
    from scipy.signal import lfilter

    v, omega = speeds
    lon = slip[0] * v + slip[1] * v * np.abs(omega)
    lat = slip[2] * v * omega + slip[3] * omega
    ang = slip[4] * omega + slip[5] * v
    motion = np.abs(v) + 0.3 * np.abs(omega)
    density = np.array(robot.white) * motion[:, None] / STEP
    white = robot.disturbance.white * np.sqrt(density) * _white(robot.disturbance.degrees, len(v), random)
    keep = np.exp(-STEP / robot.correlation_time)
    drawn = random.standard_normal((len(v), 4))
    drawn[1:] *= np.sqrt(1.0 - keep * keep)
    state = lfilter([1.0], [1.0, -keep], drawn, axis=0) * robot.slow * robot.disturbance.slow
    slow = (state[:, 0] * v, state[:, 1] * v, state[:, 2] * omega + state[:, 3] * v)
    return np.asarray(np.column_stack((lon, lat, ang)) + white + np.column_stack(slow))


def _white(degrees: float | None, count: int, random: np.random.Generator) -> Floats:
    """Noise of unit variance per step; where it is Student distributed, with the same spectral density."""
    if degrees is None:
        return random.standard_normal((count, 3))
    every = round(TAIL_SECONDS / STEP)
    drawn = random.standard_t(degrees, (count // every + 1, 3)) * np.sqrt((degrees - 2.0) / degrees / every)
    return np.repeat(drawn, every, axis=0)[:count]


def _poses(robot: Robot, twist: Floats, t: Floats, random: np.random.Generator) -> Poses:
    """Integrate the twists step by step, each along its arc, and measure."""
    yaw = np.concatenate(((0.0,), np.cumsum(twist[:-1, 2] * STEP)))
    middle = yaw[:-1] + twist[:-1, 2] * STEP / 2.0
    chord = STEP * np.sinc(twist[:-1, 2] * STEP / (2.0 * np.pi))
    c, s = np.cos(middle), np.sin(middle)
    steps = np.column_stack((c * twist[:-1, 0] - s * twist[:-1, 1], s * twist[:-1, 0] + c * twist[:-1, 1]))
    x, y = np.vstack((np.zeros(2), np.cumsum(chord[:, None] * steps, axis=0))).T
    at = slice(None, None, round(1.0 / (STEP * RATE)))
    noise = random.standard_normal((3, len(t[at])))
    measured = yaw[at] + robot.pose_std[1] * noise[2]
    return Poses(
        t=t[at] + robot.clock_offset,
        x=x[at] + robot.pose_std[0] * noise[0],
        y=y[at] + robot.pose_std[0] * noise[1],
        yaw=np.arctan2(np.sin(measured), np.cos(measured)),
        frame=np.zeros(len(t[at]), np.int64),
    )
