# SPDX-License-Identifier: Apache-2.0
"""Body twists from the readings of every wheel that a vehicle description names."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipwise import _core
from slipwise.errors import LogError
from slipwise.logs.log import Floats
from slipwise.logs.vehicle_description import VehicleDescription

_NOT_READ = math.nan


@dataclass(frozen=True, eq=False)
class WheelTwists:
    """Body twists [N]; NaN where a reading is missing."""

    v: Floats  # m/s
    vy: Floats  # m/s
    omega: Floats  # rad/s
    contradiction: (
        float  # root mean square of what readings contradict each other by, in their stated deviations
    )

    def note(self, vehicle: str) -> str:
        """Say where the twists come from, and how well the wheels agree."""
        said = "" if math.isnan(self.contradiction) else f", which agree to {self.contradiction:.2g} sigma"
        return f"odo from the wheels of {vehicle}{said}"


@dataclass(frozen=True)
class WheelNames:
    """Where the readings of a vehicle come from, by name: speeds, steering angles, and the hinge's angle."""

    speeds: tuple[str | None, ...]  # one for each wheel; None where no speed is read
    steering: tuple[str | None, ...]  # one for each wheel; None where it is not steered
    hinge: str | None = None

    @property
    def all(self) -> tuple[str, ...]:
        """Every name once."""
        named = (*self.speeds, *self.steering, self.hinge)
        return tuple(dict.fromkeys(name for name in named if name is not None))


def wheel_names(vehicle: VehicleDescription, found: Collection[str], prefixes: tuple[str, str]) -> WheelNames:
    """Return the names under which readings are found: as in the description, or with a prefix.

    Args:
        vehicle: a vehicle with wheels.
        found: names of columns or joints.
        prefixes: of speeds and of angles, such as `wheel_` and `steer_` in tables; empty for none.

    Raises:
        LogError: one is missing; the error says which.
    """

    def named(name: str | None, prefix: str) -> str | None:
        if name is None or name in found:
            return name
        if prefix + name in found:
            return prefix + name
        shown = ", ".join(list(found)[:12])
        raise LogError(f"there is no {prefix}{name}", advice=f"rename it or the wheel; found {shown}")

    speed, angle = prefixes
    return WheelNames(
        tuple(named(wheel.name if wheel.driven else None, speed) for wheel in vehicle.wheels),
        tuple(named(wheel.steer, angle) for wheel in vehicle.wheels),
        named(None if vehicle.hinge is None else vehicle.hinge.name, angle),
    )


def twists_of_wheels(
    vehicle: VehicleDescription, names: WheelNames, readings: dict[str, Floats], t: Floats
) -> WheelTwists:
    """Return the twist of each row by least squares over all wheels (derivations/wheels.md).

    Args:
        vehicle: a vehicle with wheels.
        names: of the readings.
        readings: by name [N], rad/s of speeds and rad of angles, NaN where there is none.
        t: stamps [N] s, which the rate of a hinge is taken from.
    """
    layout = vehicle.layout
    assert layout is not None
    count = len(t)
    there = np.ones(count, bool)
    for name in names.all:
        there &= np.isfinite(readings[name])
    speed, steering = (np.zeros((count, len(vehicle.wheels))) for _ in range(2))
    for k, (own, angle_name) in enumerate(zip(names.speeds, names.steering, strict=True)):
        speed[:, k] = _NOT_READ if own is None else readings[own]
        if angle_name is not None:
            steering[:, k] = readings[angle_name]
    hinge = np.zeros((0, 2))
    if names.hinge is not None:
        angle = readings[names.hinge]
        hinge = np.stack([angle, _rate(t, angle, there)], axis=1)[there]
    result = np.full((count, 5), np.nan)
    if there.any():
        result[there] = _twists(layout, speed[there], steering[there], hinge)
    squares, freedom = np.nansum(result[:, 3]), np.nansum(result[:, 4])
    agree = math.sqrt(squares / freedom) if freedom > 0.0 else math.nan
    return WheelTwists(result[:, 0], result[:, 1], result[:, 2], agree)


def _twists(layout: _core.WheelLayout, speed: Floats, steering: Floats, hinge: Floats) -> Floats:
    try:
        twists, _ = layout.twists(speed, steering, hinge)
    except ValueError as wrong:
        raise LogError(str(wrong), where="wheels", advice="docs/vehicles.md has every key") from wrong
    return np.asarray(twists)


def _rate(t: Floats, angle: Floats, there: Floats) -> Floats:
    """Return the backward difference of an angle [N] over the rows that have it: nothing later is used."""
    rate = np.zeros(len(t))
    rows = np.flatnonzero(there)
    steps = np.diff(t[rows])
    moved = np.diff(angle[rows])
    rate[rows[1:]] = np.where(steps > 0.0, moved / np.where(steps > 0.0, steps, 1.0), 0.0)
    return rate


class JointReadings:
    """Takes the speeds of all wheels and all angles out of joint states, in the order of `names`."""

    def __init__(self, vehicle: VehicleDescription) -> None:
        self._vehicle = vehicle
        self._joints: tuple[str, ...] = ()
        self._places: tuple[tuple[bool, int], ...] = ()
        self.names: WheelNames = wheel_names(vehicle, _every_name(vehicle), ("", ""))

    def __call__(self, message: Any) -> tuple[float, ...]:
        """Return one number for each of `names.all`: speeds [rad/s] and angles [rad]; NaN where it has none.

        Raises:
            LogError: a joint is missing.
        """
        joints = tuple(message.name)
        if joints != self._joints:
            wheel_names(self._vehicle, joints, ("", ""))
            speeds = {name for name in self.names.speeds if name is not None}
            self._places = tuple((name in speeds, joints.index(name)) for name in self.names.all)
            self._joints = joints
        return tuple(
            _at(message.velocity if speed else message.position, place) for speed, place in self._places
        )


def _every_name(vehicle: VehicleDescription) -> list[str]:
    names = [wheel.name for wheel in vehicle.wheels] + [
        w.steer for w in vehicle.wheels if w.steer is not None
    ]
    return names + ([] if vehicle.hinge is None else [vehicle.hinge.name])


def _at(values: Any, place: int) -> float:
    return float(values[place]) if place < len(values) else math.nan
