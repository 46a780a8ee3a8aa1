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
from slipwise.logs.vocabulary import PREFIXES

_NOT_READ = math.nan
_FEW = 2  # rows, of a live robot, that say nothing of how wheels agree


@dataclass(frozen=True, eq=False)
class WheelTwists:
    """Body twists [N]; NaN where a reading is missing."""

    v: Floats  # m/s
    vy: Floats  # m/s
    omega: Floats  # rad/s
    squares: Floats  # of what readings contradict each other by, in their stated deviations
    freedom: Floats  # how many of these are free

    @property
    def contradiction(self) -> float:
        """The root mean square of what readings contradict each other by; not a number of too few rows."""
        squares, freedom = float(np.nansum(self.squares)), float(np.nansum(self.freedom))
        enough = freedom > 0.0 and np.count_nonzero(np.isfinite(self.freedom)) > _FEW
        return math.sqrt(squares / freedom) if enough else math.nan

    def note(self, vehicle: str) -> str:
        """Say where the twists come from, and how well the wheels agree."""
        sigmas = self.contradiction
        said = "" if math.isnan(sigmas) else f", which agree to {sigmas:.2g} sigma"
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


def wheel_names(vehicle: VehicleDescription, found: Collection[str]) -> WheelNames:
    """Return the names under which readings are found: with `wheel_` or `steer_`, or as in the description.

    Args:
        vehicle: a vehicle with wheels.
        found: names of columns or joints.

    Raises:
        LogError: one is missing; the error says which.
    """

    def named(name: str | None, prefix: str) -> str | None:
        if name is None or prefix + name in found:
            return None if name is None else prefix + name
        if name in found:
            return name
        shown = ", ".join(list(found)[:12])
        advice = f"rename it or the wheel; found {shown}"
        raise LogError(f"there is no {prefix}{name}, and no {name}", advice=advice)

    speed, angle = PREFIXES
    result = WheelNames(
        tuple(named(wheel.name if wheel.driven else None, speed) for wheel in vehicle.wheels),
        tuple(named(wheel.steer, angle) for wheel in vehicle.wheels),
        named(None if vehicle.hinge is None else vehicle.hinge.name, angle),
    )
    both = (set(result.speeds) & {*result.steering, result.hinge}) - {None}
    if both:
        advice = f"name columns or joints {speed}NAME and {angle}NAME"
        raise LogError(f"{min(map(str, both))} would be a speed and an angle at once", advice=advice)
    return result


def twists_of_wheels(
    vehicle: VehicleDescription, names: WheelNames, readings: dict[str, Floats], t: Floats
) -> WheelTwists:
    """Return the twist of each row by least squares over all wheels (derivations/sensors.md).

    Args:
        vehicle: a vehicle with wheels.
        names: of the readings.
        readings: by name [N], rad/s of speeds and rad of angles, NaN where there is none.
        t: stamps [N] s, which rates of a hinge, and of steering about a pivot, are taken from.
    """
    layout = vehicle.layout
    assert layout is not None
    there = np.ones(len(t), bool)
    for name in names.all:
        there &= np.isfinite(readings[name])
    speed, steering, rate = (np.zeros((len(t), len(vehicle.wheels))) for _ in range(3))
    for k, wheel in enumerate(vehicle.wheels):
        own, angle_name = names.speeds[k], names.steering[k]
        speed[:, k] = _NOT_READ if own is None else _signed(readings[own], wheel.reversed)
        if angle_name is not None:
            steering[:, k] = _signed(readings[angle_name], wheel.steer_reversed)
            if wheel.pivot is not None:
                rate[:, k] = _rate(t, steering[:, k], there)
    hinge = np.zeros((0, 2))
    if names.hinge is not None:
        angle = readings[names.hinge]
        hinge = np.stack([angle, _rate(t, angle, there)], axis=1)[there]
    result = np.full((len(t), 5), np.nan)
    if there.any():
        rates = rate[there] if layout.pivoted else rate[:0]
        result[there] = _twists(layout, speed[there], steering[there], hinge, rates)
    return WheelTwists(*result.T)


def _signed(values: Floats, backwards: bool) -> Floats:
    return -values if backwards else values


def _twists(
    layout: _core.WheelLayout, speed: Floats, steering: Floats, hinge: Floats, steering_rate: Floats
) -> Floats:
    try:
        twists, _ = layout.twists(speed, steering, hinge, steering_rate)
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
        self._places: dict[tuple[str, ...], tuple[tuple[bool, int], ...] | None] = {}  # by the joints' names
        self.names: WheelNames = wheel_names(vehicle, _every_name(vehicle))

    def __call__(self, message: Any) -> tuple[float, ...]:
        """Return one number for each of `names.all`: speeds [rad/s] and angles [rad]; NaN where it has none.

        A message without any of the joints, such as that of an arm, gives no numbers.

        Raises:
            LogError: some of the joints are missing.
        """
        joints = tuple(message.name)
        if joints not in self._places:
            self._places[joints] = self._places_in(joints)
        places = self._places[joints]
        if places is None:
            return (math.nan,) * len(self.names.all)
        return tuple(_at(message.velocity if speed else message.position, place) for speed, place in places)

    def refuse_none(self) -> None:
        """Raise LogError where no message that came had any of the joints."""
        if self._places and not any(self._places.values()):
            wheel_names(self._vehicle, tuple(dict.fromkeys(name for names in self._places for name in names)))

    def check(self, message: Any) -> None:
        """Raise LogError where a message has none of the joints."""
        if all(map(math.isnan, self(message))):
            raise LogError("a message has no joints of wheels", advice=", ".join(tuple(message.name)[:12]))

    def _places_in(self, joints: tuple[str, ...]) -> tuple[tuple[bool, int], ...] | None:
        try:
            found = wheel_names(self._vehicle, joints)
        except LogError:
            own = {name for each in _every_name(self._vehicle) for name in (each, each.partition("_")[2])}
            if own.isdisjoint(joints):
                return None
            raise
        return tuple((name in found.speeds, joints.index(name)) for name in found.all)


def _every_name(vehicle: VehicleDescription) -> list[str]:
    speed, angle = PREFIXES
    angles = [wheel.steer for wheel in vehicle.wheels if wheel.steer is not None]
    angles += [] if vehicle.hinge is None else [vehicle.hinge.name]
    return [speed + wheel.name for wheel in vehicle.wheels] + [angle + name for name in angles]


def _at(values: Any, place: int) -> float:
    return float(values[place]) if place < len(values) else math.nan
