# SPDX-License-Identifier: Apache-2.0
"""Runs the vehicle's rigid-body physics under a command script and samples its true states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.ground import Grade
from slipwise.logs.log import Inputs
from slipwise_sim.engine import load_mujoco
from slipwise_sim.hillside import gravity_on, seen_from_above
from slipwise_sim.land_tamer import LandTamer, mjcf, wheel_names
from slipwise_sim.push import Push, StuckWheel
from slipwise_sim.traction_law import TractionLaw, traction_force
from slipwise_sim.truth import Truth
from slipwise_sim.tyre_law import ForceLaw, TyreForceTerrain, TyreLaw, tyre_forces

TERRAINS = ("tyre-force", "traction-law", "contact-friction")
LONGEST_STEP = 0.002  # [s] short enough for smooth contact friction; tyre forces alone would allow 0.005
SETTLING_TIME = 1.0  # [s] at rest before the log begins, for the suspension to find its balance

Progress = Callable[[float], None]


@dataclass(frozen=True)
class TerrainChange:
    """A tyre-force terrain that becomes another one while the vehicle drives."""

    t: float  # [s]
    law: TyreLaw


@dataclass(frozen=True)
class World:
    """The vehicle and what it stands on."""

    vehicle: LandTamer
    terrain: str  # one of TERRAINS
    law: TyreLaw  # of it MuJoCo's own contact friction uses `friction` alone
    traction: TractionLaw = TractionLaw()
    change: TerrainChange | None = None
    grade: Grade | None = None  # of a hillside; level where there is none
    push: Push | None = None  # on the hull
    stuck: StuckWheel | None = None

    @property
    def force_law(self) -> ForceLaw | None:
        """The law of the terrain's forces; None where MuJoCo's contacts give them."""
        if self.terrain == "contact-friction":
            return None
        if self.terrain == "traction-law":
            return partial(traction_force, self.traction)
        return tyre_forces(self.law)


@dataclass(frozen=True)
class Sampling:
    """Times of the true states: t = 0, 1/rate, ..., and the whole number of physics steps between them."""

    count: int  # states
    rate: float  # [Hz]
    steps: int  # physics steps from one state to the next

    @staticmethod
    def over(duration: float, rate: float) -> Sampling:
        """Sample [0, duration] s at `rate` Hz."""
        return Sampling(
            count=math.floor(duration * rate + 1e-9) + 1,
            rate=rate,
            steps=math.ceil(1 / (rate * LONGEST_STEP) - 1e-9),
        )

    @property
    def time_step(self) -> float:
        """Length of a physics step [s]."""
        return 1 / (self.rate * self.steps)


def wheel_targets(vehicle: LandTamer, commands: Inputs, sampling: Sampling) -> NDArray[np.float64]:
    """Left and right wheel rate that the drives aim at in every physics step [rad/s], shape [steps, 2].

    Commands are held until the next one, and arrive late by the vehicle's delay. A step in which a command
    arrives gets the mean over the step, so that the delay need not be a whole number of steps.
    """
    step = sampling.time_step
    edges = np.arange((sampling.count - 1) * sampling.steps + 1) * step
    arrivals = commands.t + vehicle.command_delay
    knots = np.append(arrivals, max(arrivals[-1], edges[-1]) + step)
    rates = vehicle.side_rates(commands.v, commands.omega)
    angle = np.concatenate([np.zeros((1, 2)), np.cumsum(rates * np.diff(knots)[:, None], axis=0)])
    turned = np.stack([np.interp(edges, knots, side) for side in angle.T], axis=-1)
    targets: NDArray[np.float64] = np.diff(turned, axis=0) / step
    return targets


@dataclass(frozen=True)
class Physics:
    """A vehicle on its terrain; `advance` takes one step under the wheel rates in `data.ctrl`."""

    model: Any
    data: Any
    advance: Callable[[], None]
    tyres: TyreForceTerrain | None  # None where MuJoCo's contacts give the forces


def start_physics(world: World, time_step: float) -> Physics:
    """Put the vehicle at the world's origin, facing along x, and let its suspension find its balance.

    Raises:
        SettingsError: the vehicle is impossible.
        SlipwiseError: MuJoCo is not installed.
    """
    mujoco = load_mujoco()
    force_law = world.force_law
    friction = world.law.friction if force_law is None else None
    xml = mjcf(world.vehicle, time_step=time_step, friction=friction, gravity=gravity_on(world.grade))
    try:
        model = mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        advice = "use values nearer the defaults"
        raise SettingsError("MuJoCo refuses the vehicle", where=str(error), advice=advice) from error
    data = mujoco.MjData(model)
    tyres = None if force_law is None else TyreForceTerrain(force_law, world.vehicle, model, data)
    advance = _stepper(mujoco, model, data, tyres)
    for _ in range(math.ceil(SETTLING_TIME / time_step)):
        advance()
    return Physics(model, data, advance, tyres)


def run_physics(
    world: World, commands: Inputs, sampling: Sampling, *, progress: Progress | None = None
) -> Truth:
    """Drive the vehicle from rest at the world's origin, facing along x.

    Args:
        world: the vehicle and the terrain.
        commands: what the vehicle is commanded; nothing is commanded before the first.
        sampling: times of the states.
        progress: called now and then with the fraction done.

    Raises:
        SettingsError: the vehicle is impossible.
        SlipwiseError: MuJoCo is not installed, or the physics became unstable.
    """
    physics = start_physics(world, sampling.time_step)
    model, data = physics.model, physics.data
    names = wheel_names(world.vehicle)
    change, tyres = world.change, physics.tyres
    changes_at = math.ceil(change.t * sampling.rate - 1e-9) if change is not None else sampling.count
    targets = wheel_targets(world.vehicle, commands, sampling)[:, np.arange(len(names)) % 2]
    _block(targets, world, sampling)
    push, hull = world.push, model.body("hull").id
    position = np.empty((sampling.count, model.nq))
    velocity = np.empty((sampling.count, model.nv))
    for sample in range(sampling.count):
        position[sample], velocity[sample] = data.qpos, data.qvel
        if change is not None and tyres is not None and sample == changes_at:
            tyres.law = tyre_forces(change.law)
        for target in targets[sample * sampling.steps : (sample + 1) * sampling.steps]:
            data.ctrl = target
            if push is not None:
                push.apply(data, hull, sample / sampling.rate)
            physics.advance()
        if progress is not None and (sample % 100 == 99 or sample == sampling.count - 1):
            progress((sample + 1) / sampling.count)
    spins = np.array([model.joint(f"spin_{name}").dofadr[0] for name in names])
    rates = _at_encoders(velocity[:, spins], world, sampling)
    truth = planar_truth(np.arange(sampling.count) / sampling.rate, position, velocity, rates)
    return truth if world.grade is None else seen_from_above(truth, position, world.grade)


def _block(targets: NDArray[np.float64], world: World, sampling: Sampling) -> None:
    """Ask a stuck wheel to stand, in place; its drive is stronger than the friction of the ground."""
    if world.stuck is not None:
        first = math.ceil(world.stuck.start * sampling.rate - 1e-9) * sampling.steps
        targets[first:, world.stuck.column(world.vehicle)] = 0.0


def _at_encoders(spins: NDArray[np.float64], world: World, sampling: Sampling) -> NDArray[np.float64]:
    """What encoders measure, [M, wheels]: that of a stuck wheel sits in another one of its side."""
    if world.stuck is None:
        return spins
    column = world.stuck.column(world.vehicle)
    other = column + 2 if column + 2 < spins.shape[1] else column - 2
    first = math.ceil(world.stuck.start * sampling.rate - 1e-9)
    measured = spins.copy()
    measured[first:, column] = spins[first:, other]
    return measured


def _stepper(mujoco: Any, model: Any, data: Any, tyres: TyreForceTerrain | None) -> Callable[[], None]:
    """Return a function that advances the physics by one step."""
    if tyres is None:
        return lambda: mujoco.mj_step(model, data)
    step1, step2, apply = mujoco.mj_step1, mujoco.mj_step2, tyres.apply

    def advance() -> None:
        step1(model, data)
        apply()
        step2(model, data)

    return advance


def planar_truth(
    t: NDArray[np.float64],
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    spin: NDArray[np.float64],
) -> Truth:
    """Planar states from MuJoCo's: world position, quaternion, world velocity, body angular velocity."""
    if not np.isfinite(position).all():
        raise unstable()
    w, x, y, z = position[:, 3:7].T
    yaw = np.unwrap(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    cos, sin = np.cos(yaw), np.sin(yaw)
    up = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1)
    return Truth(
        t=t,
        x=position[:, 0].copy(),
        y=position[:, 1].copy(),
        yaw=yaw,
        vx=cos * velocity[:, 0] + sin * velocity[:, 1],
        vy=cos * velocity[:, 1] - sin * velocity[:, 0],
        omega=np.einsum("ij,ij->i", up, velocity[:, 3:6]),
        wheel_left=spin[:, 0::2].mean(axis=1),
        wheel_right=spin[:, 1::2].mean(axis=1),
    )


def unstable() -> SlipwiseError:
    """Return what is raised where the physics does not stay finite."""
    return SlipwiseError("the physics became unstable", advice="use values nearer the defaults")
