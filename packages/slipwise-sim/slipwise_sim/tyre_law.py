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
    return tyre_forces(law)(load, patch_velocity, rim_speed)


def tyre_forces(law: TyreLaw) -> ForceLaw:
    """Return `tyre_force` of a terrain: most of a simulation is spent in it, so its constants are arrays."""
    friction, creep, drag_speed = map(np.array, (law.friction, law.creep_speed, law.drag_speed))
    resistance, ahead, aside = map(
        np.array, (law.rolling_resistance, law.slip_stiffness, -law.cornering_stiffness)
    )
    tiny = np.array(1e-9)

    def force(
        load: NDArray[np.float64], patch_velocity: NDArray[np.float64], rim_speed: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        forward = patch_velocity[0]
        reference = np.maximum(np.maximum(np.abs(forward), np.abs(rim_speed)), creep)
        slip = np.empty_like(patch_velocity)
        np.multiply(ahead, rim_speed - forward, slip[0])
        np.multiply(aside, patch_velocity[1], slip[1])
        np.divide(slip, reference, slip)
        squares = slip * slip
        size = np.sqrt(squares[0] + squares[1]) + tiny
        np.multiply(slip, friction * load * np.tanh(size) / size, slip)
        drag = resistance * load * np.tanh(forward / drag_speed)
        np.subtract(slip[0], drag, slip[0])
        return slip

    return force


class TyreForceTerrain:
    """Applies a law of force to a MuJoCo model of the vehicle; call `apply` between mj_step1 and mj_step2."""

    def __init__(self, law: ForceLaw, vehicle: LandTamer, model: Any, data: Any) -> None:
        """Look up where the vehicle's parts are in the model's arrays.

        Args:
            law: the force of the terrain on each wheel.
            vehicle: the constants.
            model: the mujoco.MjModel made from `land_tamer.mjcf`, with frictionless contacts.
            data: its mujoco.MjData, whose arrays stay where they are.
        """
        names = wheel_names(vehicle)
        self.law = law  # may be replaced while driving: another terrain
        self._radius = np.array(vehicle.wheel_radius)
        self._arms = np.array([[-vehicle.wheel_radius], [vehicle.wheel_radius]])
        self._patch_jacobian = _patch_jacobian(vehicle)
        first = model.body(f"wheel_{names[0]}").id
        spins = [model.joint(f"spin_{name}").dofadr[0] for name in names]
        self._loads, self._forces = data.sensordata, data.xfrc_applied[first : first + len(names)]
        self._axes = data.xmat[model.body("hull").id].reshape(3, 3)
        self._velocity, self._turning = data.qvel[:3], data.qvel[3:6]
        self._spins = data.qvel[spins[0] : spins[-1] + 1 : spins[1] - spins[0]]
        self._twist, self._wrenches = np.empty(6), np.empty((2, 6))

    def apply(self) -> None:
        """Write the terrain's forces on the wheels into `xfrc_applied`.

        The loads are those of the previous step (the solver has not run in this one yet); all else is new.
        """
        twist, wrenches, axes = self._twist, self._wrenches, self._axes
        np.dot(self._velocity, axes, twist[:3])
        twist[3:] = self._turning
        patch_velocity = self._patch_jacobian.dot(twist).reshape(2, -1)
        force = self.law(self._loads, patch_velocity, self._spins * self._radius)
        wrenches[:, :3] = axes.T[:2]  # forward and left
        np.multiply(self._arms, axes.T[1::-1], wrenches[:, 3:])
        np.dot(force.T, wrenches, self._forces)


def _patch_jacobian(vehicle: LandTamer) -> NDArray[np.float64]:
    """Patch velocities over the hull's twist in the hull's frame, the suspension at rest; [2 wheels, 6]."""
    x, y = vehicle.wheel_places.T
    z = -(vehicle.ground_clearance + vehicle.wheel_radius)
    zero, one = np.zeros_like(x), np.ones_like(x)
    forward = np.stack([one, zero, zero, zero, zero + z, -y], axis=-1)
    left = np.stack([zero, one, zero, zero - z, zero, x], axis=-1)
    return np.concatenate([forward, left])
