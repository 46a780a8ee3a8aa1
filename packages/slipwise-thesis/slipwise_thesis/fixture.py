# SPDX-License-Identifier: Apache-2.0
"""What the figures are made from: simulated drives, each made once when first needed, and real logs."""

from __future__ import annotations

import contextlib
import itertools
import signal
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slipwise.errors import LogError, SlipwiseError
from slipwise.logs import Inputs, Log, open_log
from slipwise_sim import Scenario, Simulation, hold, simulate
from slipwise_sim.engine import load_mujoco

SPEEDS = (0.5, 1.0, 1.5, 2.0)  # [m/s]
CURVATURES = (0.1, 0.25, 0.5)  # [1/m], driven to both sides
CIRCLE = (0.5, 0.5)  # [m/s], [1/m] of figure 4.1
DISTURBANCE = (0.05, 0.1)  # [m/s], [rad/s] added to held commands, drawn again every 0.05 s
STD_XY, STD_YAW = 0.005, 0.015  # [m], [rad] of a measured pose under held commands
ENDINGS = (".csv.gz", ".csv", ".parquet", ".mcap", "")


class MissingLogError(LogError):
    """A real log is not there."""


@dataclass(frozen=True)
class FixtureSize:
    """How much is simulated."""

    circle_speeds: tuple[float, ...] = SPEEDS  # [m/s]
    circle_time: float = 33.0  # [s] on each of the circles
    one_circle_time: float = 303.0  # [s] on the circle of figure 4.1
    long_time: float = 540.0  # [s] of the drive with changing commands
    drawn_groups: int = 60  # of segments with known slip and noise
    largest_process: int = 2_000  # examples of the largest Gaussian process that is timed
    seeds: int = 100  # drives of known slip and noise


FULL = FixtureSize()
SMALL = FixtureSize(
    circle_speeds=(1.0, 2.0),
    circle_time=9.2,
    one_circle_time=18.0,
    long_time=60.0,
    drawn_groups=4,
    largest_process=200,
    seeds=2,
)


class Fixture:
    """Drives by name. The same seed and size give the same drives."""

    def __init__(self, *, seed: int = 1, data: Path | None = None, size: FixtureSize = FULL) -> None:
        """Simulate nothing yet.

        Args:
            seed: of everything that is drawn at random.
            data: folder of real logs, None where there is none.
            size: how long the simulated drives are.
        """
        self.seed, self.data, self.size = seed, data, size
        self._made: dict[str, Simulation] = {}
        self._logs: dict[str, Log] = {}

    def circles(self, terrain: str = "tyre-force") -> Simulation:
        """Return held commands: speeds times curvatures to both sides; drives are disturbed."""
        held = [
            (v, side * curvature * v)
            for v, curvature, side in itertools.product(self.size.circle_speeds, CURVATURES, (1, -1))
        ]
        return self._held(f"circles, {terrain}", held, self.size.circle_time, terrain)

    def one_circle(self, terrain: str = "tyre-force") -> Simulation:
        """Return one command held for long, that of figure 4.1."""
        v, curvature = CIRCLE
        return self._held(f"one circle, {terrain}", [(v, v * curvature)], self.size.one_circle_time, terrain)

    def long_drive(self, terrain: str = "tyre-force") -> Simulation:
        """Return nine minutes of circles and random driving."""
        name = f"long, {terrain}"
        if name not in self._made:
            scenario = Scenario(duration=self.size.long_time, terrain=terrain)
            self._made[name] = simulate(scenario, seed=self.seed)
        return self._made[name]

    def real_log(self, name: str) -> Log:
        """Return a log of the data folder by its path without ending, as "husky/tile_deflated_tyres".

        Raises:
            MissingLogError: there is no data folder, or the log is not in it.
        """
        if self.data is None:
            raise MissingLogError(
                f"the log {name} is missing: no folder of real logs is given",
                advice="set SLIPWISE_DATA or --data to the folder that holds it",
            )
        if name not in self._logs:
            found = [self.data / f"{name}{ending}" for ending in ENDINGS]
            path = next((path for path in found if path.exists()), None)
            if path is None:
                raise MissingLogError(
                    f"the log {name} is missing",
                    where=str(self.data),
                    advice=f"put it there as {name}.csv.gz",
                )
            self._logs[name] = open_log(path)
        return self._logs[name]

    def _held(self, name: str, held: list[tuple[float, float]], time: float, terrain: str) -> Simulation:
        """Drive commands (v, omega), each for `time`; the log does not hold the disturbance."""
        if name not in self._made:
            commanded = _one_after_the_other([hold(v, omega, time) for v, omega in held])
            rng = np.random.Generator(np.random.PCG64([self.seed, len(held)]))
            off = rng.standard_normal((2, len(commanded))) * np.array(DISTURBANCE)[:, None]
            driven = replace(commanded, v=commanded.v + off[0], omega=commanded.omega + off[1])
            duration = time * len(held)
            scenario = Scenario(duration, commands=driven, terrain=terrain, std_xy=STD_XY, std_yaw=STD_YAW)
            simulation = simulate(scenario, seed=self.seed)
            runs = tuple(replace(run, commands=commanded) for run in simulation.log.runs)
            self._made[name] = replace(simulation, log=replace(simulation.log, runs=runs))
        return self._made[name]


def _one_after_the_other(parts: list[Inputs]) -> Inputs:
    starts = np.cumsum([0.0] + [len(part) / 20.0 for part in parts[:-1]])
    t = np.concatenate([part.t + start for part, start in zip(parts, starts, strict=True)])
    v, vy, omega = (np.concatenate([getattr(part, name) for part in parts]) for name in ("v", "vy", "omega"))
    return Inputs(t=t, v=v, vy=vy, omega=omega)


def load_simulator() -> None:
    """Load MuJoCo with SIGTERM held back: it starts programs of its own then, which would complain."""
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    with contextlib.suppress(SlipwiseError):
        load_mujoco()
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGTERM,))
