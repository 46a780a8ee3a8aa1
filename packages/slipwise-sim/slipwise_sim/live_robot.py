# SPDX-License-Identifier: Apache-2.0
"""A simulated robot that takes its commands while it drives, for controllers."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from slipwise.errors import SettingsError
from slipwise_sim.land_tamer import wheel_names
from slipwise_sim.physics import LONGEST_STEP, World, start_physics, unstable
from slipwise_sim.tyre_law import TyreLaw, tyre_forces


@dataclass(frozen=True)
class LiveState:
    """The robot now."""

    t: float  # s
    pose: tuple[float, float, float]  # x, y [m], yaw [rad], continuous
    drive: tuple[float, float]  # v [m/s], omega [rad/s] as the wheels show them


class LiveRobot:
    """Starts at rest at the world's origin, facing along x. The same commands give the same drive.

    Args:
        world: the vehicle and what it stands on.
        period: time that every command is held [s].

    Raises:
        SettingsError: the period is not positive, or the vehicle is impossible.
        SlipwiseError: MuJoCo is not installed.
    """

    def __init__(self, world: World, *, period: float) -> None:
        if not (math.isfinite(period) and period > 0.0):
            raise SettingsError(f"the period is {period}", where="period", advice="give a positive number")
        self._steps = math.ceil(period / LONGEST_STEP - 1e-9)
        self._step = period / self._steps
        self._vehicle = world.vehicle
        self._physics = start_physics(world, self._step)
        names = wheel_names(world.vehicle)
        self._side = np.arange(len(names)) % 2
        self._spins = np.array([self._physics.model.joint(f"spin_{name}").dofadr[0] for name in names])
        self._underway: deque[tuple[float, float, float]] = deque()  # arrival [s], v, omega
        self._done = 0  # physics steps
        self._yaw = 0.0

    def state(self) -> LiveState:
        """Return the state now, without noise.

        Raises:
            SlipwiseError: the physics became unstable.
        """
        position, spins = self._physics.data.qpos, self._physics.data.qvel[self._spins]
        if not np.isfinite(position).all():
            raise unstable()
        x, y, _, a, b, c, d = position[:7].tolist()
        turned = float(np.arctan2(2 * (a * d + b * c), 1 - 2 * (c * c + d * d)))
        self._yaw += math.remainder(turned - self._yaw, 2.0 * math.pi)
        v, omega = self._vehicle.odometry(*spins.reshape(-1, 2).mean(axis=0)[:, None])
        return LiveState(self._done * self._step, (x, y, self._yaw), (float(v[0]), float(omega[0])))

    def tell(self, v: float, omega: float) -> LiveState:
        """Send one command [m/s, rad/s], let a period pass, and return the state then.

        A command acts from the physics step on in whose middle it has arrived.

        Raises:
            SettingsError: the command is not finite.
            SlipwiseError: the physics became unstable.
        """
        if not (math.isfinite(v) and math.isfinite(omega)):
            raise SettingsError(f"the command is {v}, {omega}", where="command", advice="give finite speeds")
        self._underway.append((self._done * self._step + self._vehicle.command_delay, v, omega))
        for _ in range(self._steps):
            while self._underway and self._underway[0][0] <= (self._done + 0.5) * self._step:
                speed, turn = (np.array([value]) for value in self._underway.popleft()[1:])
                self._physics.data.ctrl = self._vehicle.side_rates(speed, turn)[0, self._side]
            self._physics.advance()
            self._done += 1
        return self.state()

    def stand_on(self, law: TyreLaw) -> None:
        """Put another floor under the wheels: from the next physics step on its law gives the forces.

        Raises:
            SettingsError: the world's terrain has no law that could be replaced.
        """
        if self._physics.tyres is None:
            advice = 'use the terrain "tyre-force"'
            raise SettingsError("a contact-friction terrain cannot change", where="terrain", advice=advice)
        self._physics.tyres.law = tyre_forces(law)
