# SPDX-License-Identifier: Apache-2.0
"""Drives of a simulated vehicle on steered wheels: what its joints read, what it did, and a log of both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.log import Inputs, Log, Poses, Run
from slipwise.logs.wheel_readings import WheelTwists, twists_of_wheels, wheel_names
from slipwise_sim.engine import load_mujoco
from slipwise_sim.physics import planar_truth
from slipwise_sim.rover import STEP, RoughGround, Rover, rover_mjcf
from slipwise_sim.truth import Truth

Floats = NDArray[np.float64]

PERIOD = 0.05  # s between readings
SETTLING_TIME = 1.0  # s at rest
_POSE_NOISE = (0.004, 0.003)  # m and rad, standard deviations
_CHANNELS = ("lon", "lat", "ang")
_LEG = (1.5, 3.0)  # s, for which a command is held
_SPEEDS = (0.45, 0.3, 0.5)  # m/s, m/s, rad/s: the fastest that is commanded
_SLOWEST = 0.12  # m/s
_FASTER = (0.5, 0.5, 0.8)  # m/s^2, m/s^2, rad/s^2: the most that commands change by


@dataclass(frozen=True, eq=False)
class RoverDrive:
    """One drive: readings of all joints at the rate of the truth, by name as a table has them."""

    rover: Rover
    truth: Truth
    readings: dict[str, Floats]  # wheel_NAME [rad/s] and steer_NAME [rad], [N]
    commands: Inputs

    def wheel_twists(self) -> WheelTwists:
        """Return the body twists that the joints tell by the stated sizes."""
        vehicle = self.rover.description()
        return twists_of_wheels(
            vehicle, wheel_names(vehicle, list(self.readings)), self.readings, self.truth.t
        )

    def log(self, *, seed: int = 1) -> Log:
        """Return commands, wheels and noisy poses."""
        truth, found = self.truth, self.wheel_twists()
        rng, (std, yaw_std) = np.random.default_rng(seed), _POSE_NOISE
        x, y = (values + rng.normal(0.0, std, len(values)) for values in (truth.x, truth.y))
        yaw = truth.yaw + rng.normal(0.0, yaw_std, len(truth.yaw))
        poses = Poses(t=truth.t, x=x, y=y, yaw=yaw, frame=np.zeros(len(x), np.int64))
        wheels = Inputs(t=truth.t, v=found.v, vy=found.vy, omega=found.omega)
        run = Run("rover", self.commands, wheels, poses)
        return Log((run,), notes=(found.note("a simulated rover"),), sideways=not self.rover.bogies)


def rover_commands(rover: Rover, seconds: float, seed: int) -> Inputs:
    """Return random twists, each held for 1.5 s to 3 s; vy is 0 for a rover, which steers not all wheels."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, PERIOD)
    twists, row = np.zeros((len(t), 3)), 1
    while row < len(t):
        stay = int(rng.uniform(*_LEG) / PERIOD)
        speed = rng.choice((-1.0, 1.0, 1.0)) * rng.uniform(_SLOWEST, _SPEEDS[0])
        aside = 0.0 if rover.bogies else rng.uniform(-1.0, 1.0) * _SPEEDS[1]
        twists[row : row + stay] = speed, aside, rng.uniform(-1.0, 1.0) * _SPEEDS[2]
        row += stay
    for k in range(1, len(t)):  # as a driver's commands are: without jumps
        change = twists[k] - twists[k - 1]
        most = PERIOD * np.array(_FASTER)
        twists[k] = twists[k - 1] + np.clip(change, -most, most)
    v, vy, omega = (np.ascontiguousarray(column) for column in twists.T)
    return Inputs(t=t, v=v, vy=vy, omega=omega)


def drive_rover(rover: Rover, commands: Inputs, ground: RoughGround | None = None) -> RoverDrive:
    """Drive from rest; speeds and steering follow the commands by the stated sizes.

    Raises:
        SlipwiseError: MuJoCo is not installed, or the physics became unstable.
    """
    mujoco = load_mujoco()
    model = mujoco.MjModel.from_xml_string(rover_mjcf(rover, ground or RoughGround()))
    data = mujoco.MjData(model)
    targets = joint_targets(rover, commands)
    mujoco.mj_step(model, data, nstep=round(SETTLING_TIME / STEP))
    per_sample = round(PERIOD / STEP)
    position, velocity = (np.empty((len(commands), width)) for width in (model.nq, model.nv))
    angle = np.empty_like(position)
    for k, target in enumerate(targets):
        position[k], velocity[k] = data.qpos, data.qvel
        data.ctrl = target
        mujoco.mj_step(model, data, nstep=per_sample)
        angle[k] = data.qpos
    truth = planar_truth(commands.t, position, velocity, np.zeros((len(commands), 2)))
    return RoverDrive(rover, truth, _readings(rover, model, position, angle), commands)


def joint_targets(rover: Rover, commands: Inputs) -> Floats:
    """Return the angles [rad] of steered wheels and the speeds [rad/s] of all, [N, joints]."""
    layout = rover.description().layout
    assert layout is not None
    speed, steering = layout.wheels_for(commands.twists())
    steered = [wheel.steered for wheel in layout.wheels]
    return np.column_stack((steering[:, steered], speed))


def _readings(rover: Rover, model: Any, begin: Floats, end: Floats) -> dict[str, Floats]:
    """Encoders: the mean speed until the next reading, and the mean angle."""
    found: dict[str, Floats] = {}
    for name, _, _, steered in rover.wheels:
        spin = model.joint(f"spin_{name}").qposadr[0]
        found[f"wheel_{name}"] = (end[:, spin] - begin[:, spin]) / PERIOD
        if steered:
            steer = model.joint(f"steer_{name}").qposadr[0]
            found[f"steer_{name}"] = (begin[:, steer] + end[:, steer]) / 2.0
    return found


def mean_twists(truth: Truth) -> Floats:
    """Return the body twist [N - 1, 3] that takes each true pose to the next one, held in between."""
    step = np.diff(truth.yaw)
    half = truth.yaw[:-1] + step / 2.0
    dx, dy = np.diff(truth.x), np.diff(truth.y)
    chord = np.sinc(step / (2.0 * math.pi))  # of an arc, over its length
    v = (np.cos(half) * dx + np.sin(half) * dy) / chord
    vy = (np.cos(half) * dy - np.sin(half) * dx) / chord
    return np.column_stack((v, vy, step)) / np.diff(truth.t)[:, None]


def true_slip(drive: RoverDrive, basis: _core.Basis) -> dict[str, float]:
    """Return the slip parameters, such as `lon.V`, that take what the wheels tell to what the vehicle did.

    Least squares over all true steps, channel by channel: nothing of it is noisy.
    """
    found = drive.wheel_twists()
    wheels = np.column_stack((found.v, found.vy, found.omega))[:-1]
    slip = mean_twists(drive.truth) - wheels
    states = (_core.SlipState(v, omega, 0.0, 0.0, vy) for v, vy, omega in wheels.tolist())
    features = np.array([basis.features(state) for state in states])
    truth, first = dict[str, float](), 0
    for channel, terms in enumerate((basis.lon, basis.lat, basis.ang)):
        columns = features[:, first : first + len(terms)]
        values = np.linalg.lstsq(columns, slip[:, channel], rcond=None)[0]
        truth |= {f"{_CHANNELS[channel]}.{term}": float(v) for term, v in zip(terms, values, strict=True)}
        first += len(terms)
    return truth
