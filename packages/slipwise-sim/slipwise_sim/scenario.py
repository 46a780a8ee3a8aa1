# SPDX-License-Identifier: Apache-2.0
"""Turns a scenario into a log as a robot would record it, with the truth beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.ground import Grade
from slipwise.logs.log import Inputs, Log, Poses, Run
from slipwise_sim.drive import DRIVES
from slipwise_sim.land_tamer import LandTamer
from slipwise_sim.perturbation import Perturbation, perturbed_truth
from slipwise_sim.physics import TERRAINS, Progress, Sampling, TerrainChange, World, run_physics
from slipwise_sim.push import Push, StuckWheel
from slipwise_sim.traction_law import TractionLaw
from slipwise_sim.truth import Truth
from slipwise_sim.tyre_law import TyreLaw

_RANGES = {  # of a scenario's numbers: least, most, unit; beyond them a simulation has no sense, or no end
    "duration": (0.1, 86400.0, "s"),
    "pose_rate": (0.1, 1000.0, "Hz"),
    "std_xy": (0.0, 1000.0, "m"),
    "std_yaw": (0.0, 10.0, "rad"),
    "std_tilt": (0.0, 1.0, "rad"),
    "pose_delay": (-1000.0, 1000.0, "s"),
}


@dataclass(frozen=True)
class Scenario:
    """What is simulated, and how it is measured."""

    duration: float = 300.0  # [s]
    drive: str = "thesis"  # name of a command script in DRIVES
    commands: Inputs | None = None  # drive by these instead of a script
    terrain: str = "tyre-force"  # or "traction-law", or "contact-friction", MuJoCo's own
    vehicle: LandTamer = LandTamer()
    tyre: TyreLaw = TyreLaw()
    traction: TractionLaw = TractionLaw()
    limits: _core.CommandLimits | None = None  # what the drive does to commands before its delay and lag
    change: TerrainChange | None = None  # of a tyre-force terrain, while driving
    perturbation: Perturbation | None = None  # slip surfaces in place of terrain and physics
    pose_rate: float = 20.0  # [Hz] of poses and of wheel speeds
    std_xy: float = 0.01  # [m] of a measured position, as of RTK
    std_yaw: float = 0.003  # [rad] of a measured heading
    pose_delay: float = 0.0  # [s] by which the stamps of poses are late, as seen on the clock of the commands
    grade: Grade | None = None  # of a hillside, with poses in space; level where there is none
    std_tilt: float = 0.003  # [rad] of a measured roll or pitch on a hillside
    push: Push | None = None  # wind, a towed load; without it nothing pushes
    stuck: StuckWheel | None = None  # a wheel that drags


@dataclass(frozen=True)
class Simulation:
    """A log with commands, wheel speeds and noisy poses, and what was true."""

    log: Log
    truth: Truth


def simulate(scenario: Scenario, *, seed: int, progress: Progress | None = None) -> Simulation:
    """Drive a simulated vehicle and record it. The same scenario and seed give the same bytes.

    Args:
        scenario: what is simulated.
        seed: of the command script and, independently, of the pose noise and of the surfaces' noise.
        progress: called now and then with the fraction done.

    Raises:
        SettingsError: the scenario or the seed makes no sense.
        SlipwiseError: MuJoCo is not installed, or the physics became unstable.
    """
    _check(scenario, seed)
    commands = scenario.commands
    if commands is None:
        commands = DRIVES[scenario.drive](seed, scenario.duration)
    truth = _drive(scenario, _limited(commands, scenario.limits), seed, progress)
    run = Run(
        name="simulation",
        commands=commands,
        wheels=_wheels(scenario.vehicle, truth),
        poses=_measure(scenario, truth, seed),
        extra={},
    )
    terrain = f"{scenario.terrain} terrain" if scenario.perturbation is None else "slip surfaces"
    note = f"simulated: {terrain}, {scenario.duration:g} s, seed {seed}"
    return Simulation(log=Log(runs=(run,), sources=(), left_out=(), notes=(note,)), truth=truth)


def _drive(scenario: Scenario, commands: Inputs, seed: int, progress: Progress | None) -> Truth:
    sampling = Sampling.over(scenario.duration, scenario.pose_rate)
    if scenario.perturbation is None:
        world = World(
            scenario.vehicle,
            scenario.terrain,
            scenario.tyre,
            scenario.traction,
            scenario.change,
            scenario.grade,
            scenario.push,
            scenario.stuck,
        )
        return run_physics(world, commands, sampling, progress=progress)
    times = np.arange(sampling.count) / sampling.rate
    stream = _stream(seed, 1)
    return perturbed_truth(scenario.perturbation, scenario.vehicle, commands, times, random=stream)


def _limited(commands: Inputs, limits: _core.CommandLimits | None) -> Inputs:
    if limits is None:
        return commands
    history = _core.InputHistory(commands.t, commands.v, commands.vy, commands.omega)
    t, v, vy, omega = np.ascontiguousarray(_core.limited_inputs(history, limits, _core.RAMP_PIECE).rows().T)
    return Inputs(t=t, v=v, vy=vy, omega=omega)


def _stream(seed: int, number: int) -> np.random.Generator:
    """Random numbers that are not those of the command script: 0 of poses, 1 of slip, 2 of tilts."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed).spawn(number + 1)[number]))


def _wheels(vehicle: LandTamer, truth: Truth) -> Inputs:
    v, omega = vehicle.odometry(truth.wheel_left, truth.wheel_right)
    return Inputs(t=truth.t, v=v, vy=np.zeros_like(v), omega=omega)


def _measure(scenario: Scenario, truth: Truth, seed: int) -> Poses:
    """Poses with white noise and late stamps; heading wrapped as a receiver gives it."""
    noise = _stream(seed, 0).standard_normal((3, truth.t.size))
    yaw = truth.yaw + scenario.std_yaw * noise[2]
    return Poses(
        t=truth.t + scenario.pose_delay,
        x=truth.x + scenario.std_xy * noise[0],
        y=truth.y + scenario.std_xy * noise[1],
        yaw=np.arctan2(np.sin(yaw), np.cos(yaw)),
        frame=np.zeros(truth.t.size, dtype=np.int64),
        std_xy=np.full(truth.t.size, scenario.std_xy),
        std_yaw=np.full(truth.t.size, scenario.std_yaw),
        course=False,
        **_tilts(scenario, truth, seed),
    )


def _tilts(scenario: Scenario, truth: Truth, seed: int) -> dict[str, NDArray[np.float64]]:
    """Measured height, roll and pitch of a hillside; nothing on level ground."""
    if truth.z is None or truth.roll is None or truth.pitch is None:
        return {}
    noise = _stream(seed, 2).standard_normal((3, truth.t.size))
    return {
        "z": truth.z + scenario.std_xy * noise[0],
        "roll": truth.roll + scenario.std_tilt * noise[1],
        "pitch": truth.pitch + scenario.std_tilt * noise[2],
    }


def _check(scenario: Scenario, seed: int) -> None:
    if seed < 0:
        raise SettingsError(f"the seed is {seed}", where="seed", advice="give a whole number from 0 up")
    if scenario.terrain not in TERRAINS:
        advice = "choose one of " + ", ".join(TERRAINS)
        raise SettingsError(f"unknown terrain {scenario.terrain!r}", where="terrain", advice=advice)
    if scenario.change is not None:
        _check_change(scenario, scenario.change)
    if scenario.perturbation is not None and scenario.grade is not None:
        advice = "leave out one of the two"
        raise SettingsError("slip surfaces lie on level ground", where="grade", advice=advice)
    if scenario.commands is not None and len(scenario.commands) == 0:
        raise SettingsError("there are no commands", where="commands", advice="give at least one")
    if scenario.commands is None and scenario.drive not in DRIVES:
        advice = "choose one of " + ", ".join(DRIVES)
        raise SettingsError(f"unknown drive {scenario.drive!r}", where="drive", advice=advice)
    for name, (least, most, unit) in _RANGES.items():
        value = getattr(scenario, name)
        if not least <= value <= most:
            advice = f"give {least:g} to {most:g} {unit}"
            raise SettingsError(f"{name} is {value}", where=name, advice=advice)


def _check_change(scenario: Scenario, change: TerrainChange) -> None:
    if scenario.perturbation is not None:
        advice = "leave out one of the two"
        raise SettingsError("slip surfaces cannot change while driving", where="change", advice=advice)
    if scenario.terrain != "tyre-force":
        advice = 'use the terrain "tyre-force"'
        raise SettingsError(f"a {scenario.terrain} terrain cannot change", where="change", advice=advice)
    if not 0.0 <= change.t < scenario.duration:
        advice = f"let it change within the {scenario.duration:g} s of the drive"
        raise SettingsError(f"the terrain changes at {change.t:g} s", where="change", advice=advice)
