# SPDX-License-Identifier: Apache-2.0
"""A situation: a robot whose truth is known, what its logs hold, and how slipwise is told of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from matrix.logs import Sensor, write_table
from matrix.simulator import Axis, Driven, Floats, Robot, drive, held_commands, in_space, seen_from_start

SECONDS = 80.0  # of a log


@dataclass(frozen=True)
class Situation:
    """A robot, its sensors, and the options that a user would give."""

    name: str
    robot: Robot
    sensors: tuple[Sensor, ...]
    learns: str = "command"
    options: Mapping[str, object] = field(default_factory=dict)  # of `LogOptions`; @NAME is one of its files
    settings: tuple[str, ...] = ("basis=edd-2",)  # of everything that learns
    live: tuple[str, ...] = ()  # settings that tell a live node what will come
    files: Mapping[str, str] = field(default_factory=dict)  # text by name, which options name as @NAME
    before: tuple[Robot, tuple[Sensor, ...]] | None = None  # an earlier drive, which a memory begins with
    ranges: tuple[tuple[float, float], ...] = ((-0.4, 1.2), (-0.9, 0.9))  # of commands
    seconds: float = SECONDS
    truth: Mapping[str, float] = field(default_factory=dict)  # learned parameters, in physical units
    notes: tuple[str, ...] = ()  # what `calibrate` says, as patterns
    says: tuple[str, ...] = ()  # what `show` says, as patterns
    never: tuple[str, ...] = ()  # what it must not say
    bound: tuple[float, float] = (0.05, 0.03)  # m, rad by which a prediction of 4 s may end off the truth
    pushes: tuple[str, ...] = ()  # what of the slip is a force
    changed: Robot | None = None  # another robot of this sort, which `compare` and `fleet` must tell apart
    uses: tuple[str, ...] = ()  # those that it is tried with; all where there are none
    fleet: bool = False  # learning begins with a fleet's prior
    also: tuple[str, ...] = ()  # uses that are its own
    without: tuple[
        str, ...
    ] = ()  # uses in which it is no other situation than one without its `before` and prior
    turns: bool = False  # only turns are measured: where it drives to is not known
    slow: bool = False

    @property
    def axes(self) -> int:
        """How many numbers a command has."""
        return len(self.robot.axes)

    @property
    def moves(self) -> Robot:
        """The robot as its learned input moves it, where nothing pushes it that must be known.

        Wheels show what the drive did already.
        """
        axes = self.robot.axes if self.learns == "command" else tuple(Axis() for _ in self.robot.axes)
        return replace(self.robot, axes=axes, force=(0.0, math.inf))

    @property
    def exported(self) -> Robot:
        """The same on level ground and without a force of its day, as files for other tools have it."""
        slip = {name: value for name, value in self.robot.slip.items() if name not in self.pushes}
        return replace(self.moves, slip=slip, slope=0.0, wind=(0.0, 0.0))

    @property
    def ideal(self) -> Robot:
        """The robot that does at once what it is told, without slip."""
        curves = {"speeds": ((-1.0, 1.0), (-3.0, 3.0)), "curvatures": ((-1.0, 1.0), (-1.2, 1.2))}
        still = {"slip": {}, "slope": 0.0, "wind": (0.0, 0.0), "force": (0.0, math.inf)}
        return replace(self.robot, axes=tuple(Axis() for _ in self.robot.axes), **curves, **still)

    def write(self, folder: Path, name: str, seed: int, robot: Robot | None = None) -> Path:
        """Write the log of one drive of this robot, or of another one."""
        return self.write_drive(folder / f"{name}.csv", seed, robot or self.robot, self.sensors)

    def write_drive(self, path: Path, seed: int, robot: Robot, sensors: tuple[Sensor, ...]) -> Path:
        """Write the log of a drive as these sensors see it."""
        told = held_commands(self.ranges, self.seconds, seed)
        driven = drive(robot, np.arange(len(told)) * 0.05, told, self.seconds)
        random = np.random.default_rng(1000 + seed)
        return write_table(path, [sensor(robot, driven, random) for sensor in sensors])

    def reading(self, folder: Path) -> dict[str, object]:
        """Return the options for reading a log, with the paths of its files, which are written."""
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        return {
            name: str(folder / value[1:]) if isinstance(value, str) and value.startswith("@") else value
            for name, value in self.options.items()
        }

    @property
    def manoeuvre(self) -> Floats:
        """Commands to predict: a stamp and the numbers of each, three of them held over 4 s."""
        shares = np.array([(0.75, 0.85, 0.7), (0.95, 0.7, 0.85), (0.6, 0.3, 0.3)])[:, : self.axes]
        low, high = np.array(self.ranges).T
        return np.column_stack((np.array([0.0, 1.5, 3.0]), low + shares * (high - low)))

    def rows(self, commands: Floats) -> Floats:
        """Return commands with stamps as slipwise takes them."""
        return np.column_stack((commands[:, 0], self.robot.rows(commands[:, 1:])))

    def given(self, rows: Floats) -> Floats:
        """Return commands with stamps that slipwise gives as this robot takes them."""
        numbers = rows.shape[1] - 1
        assert numbers == self.axes, f"a command has {numbers} numbers, where the robot takes {self.axes}"
        return np.column_stack((rows[:, 0], self.robot.commands(rows[:, 1:])))

    def driven(self, commands: Floats, seconds: float, robot: Robot | None = None) -> Driven:
        """Return what commands [N, 1 + axes] do to the robot, from rest."""
        return drive(robot or self.moves, commands[:, 0], commands[:, 1:], seconds)

    def end(self, commands: Floats, seconds: float, robot: Robot | None = None) -> Floats:
        """Return where commands lead the robot: x, y, yaw in its frame at the start, seen from above."""
        space = in_space(robot or self.moves, self.driven(commands, seconds, robot).pose)
        return seen_from_start(space[:, [0, 1, 5]])[-1]
