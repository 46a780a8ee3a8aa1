# SPDX-License-Identifier: Apache-2.0
"""A terrain whose slip law is known: combined-slip tyre forces on frictionless contacts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise_sim.land_tamer import LandTamer, wheel_names

#: Load [N, wheels], patch velocity [m/s, (2, wheels)], rim speed [m/s, wheels] -> force [N, (2, wheels)].
ForceLaw = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class TyreLaw:
    """Constants of the terrain, the same under every wheel."""

    friction: float = 0.7  # [1] largest tangential force over normal load
    slip_stiffness: float = 12.0  # [1] longitudinal: initial slope of force/(friction load) over slip ratio
    cornering_stiffness: float = 7.0  # [1] lateral: the same over the tangent of the slip angle
    rolling_resistance: float = 0.04  # [1] drag over normal load
    creep_speed: float = 0.25  # [m/s] below it slip is measured against this speed: no force at rest
    drag_speed: float = 0.1  # [m/s] over which rolling resistance builds up


def tyre_force(
    law: TyreLaw,
    load: NDArray[np.float64],
    patch_velocity: NDArray[np.float64],
    rim_speed: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Force of the terrain on each wheel: tanh saturation of the combined slip, and rolling resistance.

    Args:
        law: the terrain.
        load: normal load [N], shape [wheels].
        patch_velocity: forward and leftward velocity of the contact patches, carried by the hubs without
            their spin [m/s], shape [2, wheels].
        rim_speed: spin times radius [m/s], shape [wheels].

    Returns:
        Forward and leftward force [N], shape [2, wheels].
    """
    forward = patch_velocity[0]
    reference = np.maximum(np.maximum(np.abs(forward), np.abs(rim_speed)), law.creep_speed)
    slip = np.empty_like(patch_velocity)
    slip[0] = law.slip_stiffness * (rim_speed - forward)
    slip[1] = -law.cornering_stiffness * patch_velocity[1]
    slip /= reference
    size = np.sqrt(slip[0] * slip[0] + slip[1] * slip[1]) + 1e-9
    force: NDArray[np.float64] = slip * (law.friction * load * np.tanh(size) / size)
    force[0] -= law.rolling_resistance * load * np.tanh(forward / law.drag_speed)
    return force


class TyreForceTerrain:
    """Applies a law of force to a MuJoCo model of the vehicle; call `apply` between mj_step1 and mj_step2."""

    def __init__(self, law: ForceLaw, vehicle: LandTamer, model: Any) -> None:
        """Look up where the vehicle's parts are in the model's arrays.

        Args:
            law: the force of the terrain on each wheel.
            vehicle: the constants.
            model: the mujoco.MjModel made from `land_tamer.mjcf`, with frictionless contacts.
        """
        names = wheel_names(vehicle)
        self.law = law  # may be replaced while driving: another terrain
        self._radius = vehicle.wheel_radius
        self._hull = model.body("hull").id
        bodies = [model.body(f"wheel_{name}").id for name in names]
        self._bodies = slice(bodies[0], bodies[-1] + 1)
        self._spins = np.array([model.joint(f"spin_{name}").dofadr[0] for name in names])
        self._patch_jacobian = _patch_jacobian(vehicle)

    def apply(self, data: Any) -> None:
        """Write the terrain's forces on the wheels into `data.xfrc_applied`.

        The loads are those of the previous step (the solver has not run in this one yet); all else is new.
        """
        axes = data.xmat[self._hull].reshape(3, 3)
        velocity = data.qvel
        twist = np.concatenate((velocity[:3] @ axes, velocity[3:6]))
        patch_velocity = (self._patch_jacobian @ twist).reshape(2, -1)
        rim_speed = velocity[self._spins] * self._radius
        force = self.law(data.sensordata, patch_velocity, rim_speed)
        forward, left = axes[:, 0], axes[:, 1]
        arm = self._radius
        wrenches = np.concatenate((forward, -arm * left, left, arm * forward)).reshape(2, 6)
        data.xfrc_applied[self._bodies] = force.T @ wrenches


def _patch_jacobian(vehicle: LandTamer) -> NDArray[np.float64]:
    """Patch velocities over the hull's twist in the hull's frame, the suspension at rest; [2 wheels, 6]."""
    x, y = vehicle.wheel_places.T
    z = -(vehicle.ground_clearance + vehicle.wheel_radius)
    zero, one = np.zeros_like(x), np.ones_like(x)
    forward = np.stack([one, zero, zero, zero, zero + z, -y], axis=-1)
    left = np.stack([zero, one, zero, zero - z, zero, x], axis=-1)
    return np.concatenate([forward, left])
