# SPDX-License-Identifier: Apache-2.0
"""A made-up robot on hills: rotations in space in small steps, slip by gravity, commands with lag."""

from __future__ import annotations

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
        k = 2.0 * np.pi / LENGTH
        size = 0.25 * self.height * k
        return float(size * np.cos(k * x)), float(-size * np.sin(k * y))


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
    state = np.zeros(4)  # x, y, z, yaw
    speed = np.zeros(2)
    rows = np.zeros((len(v), 6))
    for i, (v_now, omega_now) in enumerate(zip(v, omega, strict=True)):
        rows[i] = (*state[:3], *_tilt(hills, state), state[3])
        speed = speed + (np.array([v_now, omega_now]) - speed) * (1.0 - np.exp(-STEP / LAG))
        middle = state + 0.5 * STEP * _rate(hills, state, speed)
        state = state + STEP * _rate(hills, middle, speed)
    return rows


def _tilt(hills: Hills, state: Floats) -> tuple[float, float]:
    rise_x, rise_y = hills.rise(state[0], state[1])
    c, s = np.cos(state[3]), np.sin(state[3])
    pitch = -np.arctan(rise_x * c + rise_y * s)
    return float(np.arctan((rise_y * c - rise_x * s) * np.cos(pitch))), float(pitch)


def _rate(hills: Hills, state: Floats, speed: Floats) -> Floats:
    """Rates of x, y, z and yaw: with the yaw rate, the body turns as it does about its own z axis."""
    roll, pitch = _tilt(hills, state)
    gx, gy = GRAVITY * np.sin(pitch), -GRAVITY * np.cos(pitch) * np.sin(roll)
    v, omega = speed
    forward = 0.95 * v + hills.forward * gx
    left = hills.left * gy
    turn = 0.8 * omega + hills.turn * gy
    turned = rotation(roll, pitch, state[3])
    moved = turned @ np.array([forward, left, 0.0])
    tiny = 1e-6

    def own_turn(yaw_rate: float) -> float:
        later = state + tiny * np.array([*moved, yaw_rate])
        change = turned.T @ rotation(*_tilt(hills, later), later[3])
        return float(0.5 * (change[1, 0] - change[0, 1]) / tiny)

    without = own_turn(0.0)
    return np.array([*moved, (turn - without) / (own_turn(1.0) - without)])


def rotation(roll: float, pitch: float, yaw: float) -> Floats:
    """Return the rotation about fixed x, then y, then z."""
    cr, sr, cp, sp, cy, sy = (
        np.cos(roll),
        np.sin(roll),
        np.cos(pitch),
        np.sin(pitch),
        np.cos(yaw),
        np.sin(yaw),
    )
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
