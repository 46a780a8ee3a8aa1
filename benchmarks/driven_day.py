# SPDX-License-Identifier: Apache-2.0
"""A robot that drives for as long as wanted, simulated piece by piece.

It is commanded random speeds and yaw rates for 1 to 4 s each, and stands still now and then. Its actuators
follow after a delay with a first-order lag; slip rates are some fixed terms, and white noise of a density
that grows with the motion. Commands come at 100 Hz, wheel speeds at 50 Hz, poses at 20 Hz, the last two with
noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

COMMANDS, WHEELS, POSES = 100, 50, 20  # Hz
STEP = 1.0 / COMMANDS  # s
DELAYS, LAGS = (0.1, 0.08), (0.2, 0.15)  # s, of speed and yaw rate
WHEEL_STD, POSE_STD_XY, POSE_STD_YAW = 0.003, 0.01, 0.004  # m/s and rad/s; m; rad
DENSITY = np.array([5e-4, 2.5e-4, 1e-3])  # of slip noise [m, m, rad^2/m], per motion
STOPS = 0.05  # fraction of the commands


@dataclass(frozen=True, eq=False)
class Measured:
    """What was measured in some time, a row each."""

    commands: Floats  # [N, 4] t [s], v, vy [m/s], omega [rad/s]
    wheels: Floats  # the same
    poses: Floats  # [N, 5] t [s], x, y [m], yaw [rad], frame

    def recording(self) -> _core.Recording:
        """Return it as the core takes it."""
        return _core.Recording(self.commands, self.wheels, np.empty((0, 3)), self.poses)


class DrivenDay:
    """Measurements of one long run; what comes next continues what came before."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._step = 0  # first of the next piece
        self._left, self._wish = 0, np.zeros(2)  # steps of the present command
        self._asked = np.zeros(
            (round(max(DELAYS) / STEP), 2)
        )  # the last commands, that still are on their way
        self._driven, self._pose = np.zeros(2), np.zeros(3)

    def next(self, seconds: float) -> Measured:
        """Drive on for some whole seconds; return what was measured meanwhile."""
        count = round(seconds / STEP)
        t = (self._step + np.arange(count)) * STEP
        self._step += count
        asked = self._commands(count)
        driven = self._follow(asked)
        poses = self._drive(driven)
        zeros = np.zeros(count)
        commands = np.column_stack((t, asked[:, 0], zeros, asked[:, 1]))
        at = slice(None, None, COMMANDS // WHEELS)
        wheel_noise = WHEEL_STD * self._random.standard_normal((len(t[at]), 2))
        speeds = driven[at] + wheel_noise
        wheels = np.column_stack((t[at], speeds[:, 0], zeros[at], speeds[:, 1]))
        at = slice(None, None, COMMANDS // POSES)
        noise = (POSE_STD_XY, POSE_STD_XY, POSE_STD_YAW) * self._random.standard_normal((len(t[at]), 3))
        measured = poses[at] + noise
        measured[:, 2] = np.arctan2(np.sin(measured[:, 2]), np.cos(measured[:, 2]))
        rows = np.column_stack((t[at], measured, zeros[at]))
        return Measured(commands, wheels, rows)

    def _commands(self, count: int) -> Floats:
        asked = np.empty((count, 2))
        done = 0
        while done < count:
            if self._left == 0:
                self._left = int(self._random.integers(COMMANDS, 4 * COMMANDS))
                speed = self._random.uniform(0.3, 1.5) * self._random.choice((1.0, 1.0, 1.0, -1.0))
                wish = np.array([speed, self._random.uniform(-0.8, 0.8)])
                self._wish = wish * (self._random.random() >= STOPS)
            until = min(count, done + self._left)
            asked[done:until] = self._wish
            self._left -= until - done
            done = until
        return asked

    def _follow(self, asked: Floats) -> Floats:
        """Speed and yaw rate of the wheels, at each step."""
        from scipy.signal import lfilter

        driven, late = np.empty_like(asked), np.vstack((self._asked, asked))
        for k in range(2):
            first = len(self._asked) - round(DELAYS[k] / STEP)
            keep = np.exp(-STEP / LAGS[k])
            delayed = late[first : first + len(asked), k]
            driven[:, k], _ = lfilter([1.0 - keep], [1.0, -keep], delayed, zi=[keep * self._driven[k]])
        self._asked, self._driven = late[len(asked) :].copy(), driven[-1].copy()
        return driven

    def _drive(self, driven: Floats) -> Floats:
        """Poses at each step; the robot goes on along an arc from each to the next."""
        v, omega = driven.T
        speed, turn = np.abs(v), np.abs(omega)
        motion = np.column_stack((speed + 0.3 * turn, speed + 0.3 * turn, turn + speed / 5.0))
        noise = np.sqrt(DENSITY * motion / STEP) * self._random.standard_normal((len(v), 3))
        slip = np.column_stack((-0.05 * v - 0.03 * v * turn, 0.06 * v * omega + 0.01 * omega, -0.3 * omega))
        twist = np.column_stack((v, np.zeros(len(v)), omega)) + slip + noise
        yaw = self._pose[2] + np.concatenate(((0.0,), np.cumsum(twist[:, 2] * STEP)))
        middle = (yaw[:-1] + yaw[1:]) / 2.0
        chord = STEP * np.sinc(twist[:, 2] * STEP / (2.0 * np.pi))
        c, s = np.cos(middle), np.sin(middle)
        steps = np.column_stack((c * twist[:, 0] - s * twist[:, 1], s * twist[:, 0] + c * twist[:, 1]))
        places = self._pose[:2] + np.vstack((np.zeros(2), np.cumsum(chord[:, None] * steps, axis=0)))
        self._pose = np.array([*places[-1], np.remainder(yaw[-1], 2.0 * np.pi)])
        return np.column_stack((places[:-1], yaw[:-1]))
