# SPDX-License-Identifier: Apache-2.0
"""What sensors measure of a simulated drive, and the tidy table that holds it."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matrix.simulator import Driven, Floats, Robot, in_space

Random = np.random.Generator
Cells = Mapping[str, object]  # by column: numbers [N], or one value for all rows


@dataclass(frozen=True, eq=False)
class Stream:
    """Measurements of one sensor; a row each, at their stamps."""

    t: Floats  # [N] s
    cells: Cells


Sensor = Callable[[Robot, Driven, Random], Stream]


def every(driven: Driven, rate: float, since: float = 0.0) -> Floats:
    """Return stamps at a rate [Hz]."""
    return np.round(np.arange(since, driven.t[-1] - 0.06, 1.0 / rate), 6)


def commands(*names: str) -> Sensor:
    """What was commanded, at 20 Hz."""

    def sensed(_robot: Robot, driven: Driven, _random: Random) -> Stream:
        t = every(driven, 20.0)
        return Stream(t, dict(zip(names, driven.told[driven.at(t)].T, strict=True)))

    return sensed


def odometry(*names: str, std: float = 0.004) -> Sensor:
    """The twist of the wheels at 20 Hz, the mean over the time nearest to each stamp."""

    def sensed(_robot: Robot, driven: Driven, random: Random) -> Stream:
        t = every(driven, 20.0)
        twist = driven.mean_wheels(t) + std * random.standard_normal((len(t), 3))
        columns = dict(zip(("odo_v", "odo_vy", "odo_omega"), twist.T, strict=True))
        return Stream(t, {name: columns[name] for name in names or ("odo_v", "odo_omega")})

    return sensed


def sides(radius: float, separation: float) -> Sensor:
    """Angular speeds of the wheels of the left and the right side, at 20 Hz."""

    def sensed(_robot: Robot, driven: Driven, random: Random) -> Stream:
        t = every(driven, 20.0)
        v, _, omega = driven.mean_wheels(t).T
        left, right = ((v + sign * 0.5 * separation * omega) / radius for sign in (-1.0, 1.0))
        noise = 0.02 * random.standard_normal((2, len(t)))
        return Stream(t, {"wheel_left": left + noise[0], "wheel_right": right + noise[1]})

    return sensed


def steered(wheels: Mapping[str, tuple[float, float]], radius: float) -> Sensor:
    """Speed and steering angle of each wheel, which stands at x, y and points where it moves, at 20 Hz."""

    def sensed(_robot: Robot, driven: Driven, random: Random) -> Stream:
        t = every(driven, 20.0)
        v, vy, omega = driven.mean_wheels(t).T
        cells: dict[str, Floats] = {}
        for name, (x, y) in wheels.items():
            ahead, left = v - omega * y, vy + omega * x
            sign = np.where(ahead < 0.0, -1.0, 1.0)
            cells[f"wheel_{name}"] = sign * np.hypot(ahead, left) / radius
            cells[f"steer_{name}"] = np.arctan2(sign * left, sign * ahead)
        return Stream(t, {n: column + 0.002 * random.standard_normal(len(t)) for n, column in cells.items()})

    return sensed


@dataclass(frozen=True)
class PoseSensor:
    """A sensor of poses or positions: its errors, its clock, where it sits, and what it measures."""

    rate: float = 10.0  # Hz
    std: tuple[float, float] = (0.005, 0.003)  # m, rad
    late: float = 0.0  # s by which its stamps are late
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in base_link
    yaw: bool = True
    space: bool = False  # z, roll and pitch too
    source: str = ""
    since: float = 0.0  # s, of the first pose

    def __call__(self, robot: Robot, driven: Driven, random: Random) -> Stream:
        """Return what it measures of a drive."""
        t = every(driven, self.rate, self.since)
        x, y, z, roll, pitch, yaw = in_space(robot, driven.pose[driven.at(t)]).T
        ahead, left, turned = self.place
        noise = random.standard_normal((3, len(t)))
        cells: dict[str, object] = {
            "x": x + ahead * np.cos(yaw) - left * np.sin(yaw) + self.std[0] * noise[0],
            "y": y + ahead * np.sin(yaw) + left * np.cos(yaw) + self.std[0] * noise[1],
        }
        if self.yaw:
            measured = yaw + turned + self.std[1] * noise[2]
            cells["yaw"] = np.arctan2(np.sin(measured), np.cos(measured))
        if self.space:
            cells |= {"z": z, "roll": roll, "pitch": pitch}
        if self.source:
            cells["source"] = self.source
        return Stream(t + self.late, cells)


def gyro(rate: float = 50.0, bias: float = 0.01, std: float = 0.01) -> Sensor:
    """Yaw rates, counter-clockwise, in rows of their own."""

    def sensed(_robot: Robot, driven: Driven, random: Random) -> Stream:
        t = every(driven, rate, 0.0025)
        turned = driven.moved[driven.at(t), 2]
        return Stream(t, {"gyro_z": turned + bias + std * random.standard_normal(len(t))})

    return sensed


def known_force(rate: float = 10.0, since: float = 0.0) -> Sensor:
    """The push to its left, over its mass, and none ahead."""

    def sensed(_robot: Robot, driven: Driven, _random: Random) -> Stream:
        t = every(driven, rate, since)
        return Stream(t, {"force_x": 0.0, "force_y": driven.push[driven.at(t)]})

    return sensed


def hitch(offset: float, length: float) -> Sensor:
    """The angle of a trailer to the robot, of a hitch `offset` behind it and wheels `length` behind that."""

    def sensed(_robot: Robot, driven: Driven, random: Random) -> Stream:
        step, angle, angles = driven.t[1], 0.0, []
        for v, _, omega in driven.moved.tolist():
            angles.append(angle)
            pulled = (v * math.sin(angle) + offset * omega * math.cos(angle)) / length
            angle += step * (-pulled - omega)
        t = every(driven, 10.0)
        return Stream(t, {"hitch": np.array(angles)[driven.at(t)] + 0.01 * random.standard_normal(len(t))})

    return sensed


def label(name: str) -> Sensor:
    """The surface by name, in each row of a pose."""
    return lambda _robot, driven, _random: Stream(every(driven, 10.0), {"terrain": name})


def write_table(path: Path, streams: Sequence[Stream]) -> Path:
    """Write a tidy table with a row per stamp; cells are empty where nothing was measured."""
    names = list(dict.fromkeys(name for stream in streams for name in stream.cells))
    rows: dict[float, dict[str, object]] = {}
    for stream in streams:
        t = np.round(stream.t, 6).tolist()
        columns = {
            name: np.broadcast_to(np.asarray(values), len(t)).tolist()
            for name, values in stream.cells.items()
        }
        for k, stamp in enumerate(t):
            rows.setdefault(stamp, {}).update({name: column[k] for name, column in columns.items()})
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(("t", *names))
        for stamp in sorted(rows):
            table.writerow((f"{stamp:.6f}", *(_text(rows[stamp].get(name)) for name in names)))
    return path


def _text(value: object) -> str:
    return "" if value is None else value if isinstance(value, str) else f"{value:.7g}"
