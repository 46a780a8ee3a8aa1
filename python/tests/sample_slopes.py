# SPDX-License-Identifier: Apache-2.0
"""A made-up robot on hills: rotations in space in small steps, slip by gravity, commands with lag."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Inputs, Log, Poses, Run

Floats = NDArray[np.float64]

GRAVITY = 9.80665  # m/s^2
STEP = 0.01  # s, of the simulation
EVERY = 10  # steps between poses
LAG = 0.25  # s, of both channels
LENGTH = 9.0  # m, of a hill from foot to foot


@dataclass(frozen=True)
class Hills:
    """Slip terms of gravity, and how high the ground is."""

    height: float = 0.9  # m, from a valley to a top
    forward: float = 0.06  # [s] of gx: forward slip
    left: float = 0.12  # [s] of gy: sideways slip
    turn: float = 0.05  # [s/m] of gy: a robot across a slope turns its nose down
    attitude_std: float = 0.003  # rad, of measured roll and pitch
    seconds: float = 300.0

    def rise(self, x: float, y: float) -> tuple[float, float]:
        """Rise per metre along x and y of hills in both directions."""
        k = 2.0 * math.pi / LENGTH
        size = 0.25 * self.height * k
        return size * math.cos(k * x), -size * math.sin(k * y)


def commands_of(random: np.random.Generator, seconds: float) -> tuple[Floats, Floats, Floats]:
    """Stamps, speeds and yaw rates of a drive that changes its mind every two seconds."""
    t = np.arange(0.0, seconds, 0.1)
    pieces = len(t) // 20 + 1
    v = np.repeat(random.uniform(-0.6, 1.2, pieces), 20)[: len(t)]
    omega = np.repeat(random.uniform(-0.9, 0.9, pieces), 20)[: len(t)]
    return t, v, omega


def hilly_log(seed: int, hills: Hills) -> Log:
    """Return a log of commands and poses with z, roll and pitch."""
    random = np.random.default_rng(seed)
    t, v, omega = commands_of(random, hills.seconds)
    rows = _drive(hills, np.repeat(v, EVERY), np.repeat(omega, EVERY))
    pose = rows[::EVERY]
    noise = random.normal(size=pose.shape) * np.array(
        [0.005, 0.005, 0.005, *(hills.attitude_std,) * 2, 0.004]
    )
    x, y, z, roll, pitch, yaw = np.ascontiguousarray((pose + noise).T)
    poses = Poses(t + 1e-4, x, y, yaw, np.zeros(len(t), np.int64), z=z, roll=roll, pitch=pitch)
    return Log((Run("hills", Inputs(t, v, np.zeros_like(v), omega), None, poses),))


def _drive(hills: Hills, v: Floats, omega: Floats) -> Floats:
    """Poses [N, 6] x, y, z, roll, pitch, yaw of the robot's rotation in space, integrated by midpoints."""
    x = y = z = yaw = speed = rate = 0.0
    follows = 1.0 - math.exp(-STEP / LAG)
    rows = np.zeros((len(v), 6))
    for row, v_now, omega_now in zip(rows, v.tolist(), omega.tolist(), strict=True):
        row[:] = x, y, z, *_tilt(hills, x, y, yaw), yaw
        speed, rate = speed + (v_now - speed) * follows, rate + (omega_now - rate) * follows
        half = [0.5 * STEP * each for each in _rates(hills, (x, y, yaw), (speed, rate))]
        moved = _rates(hills, (x + half[0], y + half[1], yaw + half[3]), (speed, rate))
        x, y, z, yaw = (each + STEP * by for each, by in zip((x, y, z, yaw), moved, strict=True))
    return rows


def _tilt(hills: Hills, x: float, y: float, yaw: float) -> tuple[float, float]:
    """Roll and pitch [rad] of a robot that stands there."""
    rise_x, rise_y = hills.rise(x, y)
    c, s = math.cos(yaw), math.sin(yaw)
    pitch = -math.atan(rise_x * c + rise_y * s)
    return math.atan((rise_y * c - rise_x * s) * math.cos(pitch)), pitch


def _rates(
    hills: Hills, place: tuple[float, float, float], drive: tuple[float, float]
) -> tuple[float, float, float, float]:
    """Rates of x, y, z and yaw: with the yaw rate, the body turns as it does about its own z axis."""
    x, y, yaw = place
    roll, pitch = _tilt(hills, x, y, yaw)
    gx, gy = GRAVITY * math.sin(pitch), -GRAVITY * math.cos(pitch) * math.sin(roll)
    forward = 0.95 * drive[0] + hills.forward * gx
    left = hills.left * gy
    turn = 0.8 * drive[1] + hills.turn * gy
    ahead, aside = axes(roll, pitch, yaw)
    moved = [forward * a + left * b for a, b in zip(ahead, aside, strict=True)]
    tiny = 1e-6

    def own_turn(yaw_rate: float) -> float:
        then = x + tiny * moved[0], y + tiny * moved[1], yaw + tiny * yaw_rate
        ahead_then, aside_then = axes(*_tilt(hills, *then), then[2])
        change = sum(a * b for a, b in zip(aside, ahead_then, strict=True))
        return 0.5 * (change - sum(a * b for a, b in zip(ahead, aside_then, strict=True))) / tiny

    without = own_turn(0.0)
    return moved[0], moved[1], moved[2], (turn - without) / (own_turn(1.0) - without)


def axes(
    roll: float, pitch: float, yaw: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return where a body's x and y axes point that is turned about fixed x, then y, then z."""
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return (cy * cp, sy * cp, -sp), (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr)
