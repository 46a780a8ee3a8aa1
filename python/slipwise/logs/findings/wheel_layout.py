# SPDX-License-Identifier: Apache-2.0
"""Wheels of a described vehicle that contradict each other: no body could roll as they say."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SlipwiseError
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.vehicle_description import VehicleDescription, WheelDescription
from slipwise.logs.wheel_readings import WheelNames, WheelTwists, twists_of_wheels, wheel_names

Floats = NDArray[np.float64]
if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_MUCH = 0.15  # of the wheels' speeds: slip, and a steering 0.3 rad askew, stay below
_LITTLE = 0.08  # the same, as a reservation
_SOME = 0.05  # the same, where one change of the description explains it
_EXPLAINS = 0.25  # of the disagreement is left, at most
_ALIKE = 1.2  # times the least that is left: another change explains it as well
_ENOUGH = 100  # rows in which the wheels turn
_MOST = 20_000  # rows that are looked at
_SLIDES = "wheels that do not steer slide across (slides)"
_FEW_WHEELS = 2  # of which either could be wrong
_LEAST_FACTOR, _MOST_FACTOR = 0.2, 5.0  # of one wheel's speed beside the others
_KEPT = 5_000  # rows that are kept of a live robot
_STILL = 20.0  # s of turning in which a reading stays
_SIDES = 0.05  # of the other wheels' motion is not along one line, in which one of them may stand still
_TURNS = 0.05  # rad/s
_VARIES = 0.5  # of the yaw rate's spread over the log: a steady circle has one angle
_DEGREES = math.pi / 180.0
_FEW_DEGREES = 5.0  # angles that stay below are not in degrees


class _OfReader(Check):
    """Found where readings of wheels are read, and said of what is learned from them."""

    of_input = True

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Return what the reader of a log found."""
        found = whole.log.found if whole.input_name == "wheel" else ()
        return next((each for each in found if each.kind == self.kind), None)


class WheelLayout(_OfReader):
    """Readings of wheels that go with no motion of a rigid body."""

    kind, family, reserves = "wheel-layout", "encoders", True
    means = "the wheels of a described vehicle contradict each other"
    shows = (
        "no motion explains 15 % of their speeds, or 5 % that one change of the description does; from 8 % "
        "on it is a reservation"
    )
    cure = "the change that is named"


class StillHinge(_OfReader):
    """The hinge of an articulated vehicle that never moves though it turns."""

    kind, family = "still-hinge", "encoders"
    means = "the angle of a hinge stays though the vehicle turns"
    shows = f"the same angle for {_STILL:.0f} s of turning"
    cure = "its sensor"


class StillWheel(_OfReader):
    """A wheel that never turns, or always as fast, though the others turn this way and that."""

    kind, family = "still-wheel", "encoders"
    means = "a wheel of a described vehicle stays, or turns as fast, though the others change"
    shows = f"the same speed for {_STILL:.0f} s"
    cure = "its encoder"


LAYOUTS: tuple[Check, ...] = (WheelLayout(), StillHinge(), StillWheel())
OF_LAYOUTS = {check.kind for check in LAYOUTS}


class LayoutWatch:
    """Keeps the last readings of a vehicle's wheels as they come; one thread may take while another asks.

    Args:
        vehicle: a vehicle with wheels.
    """

    def __init__(self, vehicle: VehicleDescription) -> None:
        self._vehicle = vehicle
        self._names: WheelNames | None = None
        self._rows: deque[tuple[float, ...]] = deque(maxlen=_KEPT)

    def take(self, readings: Mapping[str, float], t: float) -> None:
        """Take readings by name, rad/s and rad, of a stamp [s]; the first are whole."""
        self._names = self._names or wheel_names(self._vehicle, readings)
        self._rows.append((t, *(readings.get(name, math.nan) for name in self._names.all)))

    def found(self) -> tuple[Finding, ...]:
        """Return what they show."""
        rows = list(self._rows)  # others may come meanwhile
        if self._names is None or not rows:
            return ()
        t, *values = np.array(rows).T
        return layout_findings(self._vehicle, self._names, dict(zip(self._names.all, values, strict=True)), t)


@dataclass(frozen=True)
class _Mistake:
    """What may be wrong with a description or its readings, and the readings without it."""

    what: str
    corrected: _Read
    harmless: bool = False  # the robot itself is so, and a model of it holds


@dataclass(frozen=True)
class _Read:
    """A description with readings [N] by name."""

    vehicle: VehicleDescription
    names: WheelNames
    readings: Mapping[str, Floats]
    t: Floats  # [N] s

    def twists(self) -> WheelTwists:
        """Return what the wheels say together.

        Raises:
            SlipwiseError: they tell no motion.
        """
        return twists_of_wheels(self.vehicle, self.names, dict(self.readings), self.t)

    def disagreement(self) -> float:
        """Return what no motion explains, of the wheels' speeds; not a number where nothing would show it."""
        try:
            found = self.twists()
        except SlipwiseError:
            return math.nan
        away = self.vehicle.rolling_std * np.sqrt(found.squares / np.maximum(found.freedom, 1.0))
        rolled = [
            self.readings[name] * wheel.radius
            for name, wheel in zip(self.names.speeds, self.vehicle.wheels, strict=True)
            if name is not None
        ]
        speeds = np.sqrt(np.mean(np.square(rolled), axis=0)) if rolled else np.zeros(len(self.t))
        return float(np.sum(away) / np.sum(speeds)) if found.freedom.any() and speeds.any() else math.nan

    def with_each(self, change: Callable[[WheelDescription], dict[str, Any]]) -> _Read:
        """Return it with other values of every wheel, by key."""
        return self.described(wheels=[each.model_copy(update=change(each)) for each in self.vehicle.wheels])

    def with_wheel(self, place: int, **values: Any) -> _Read:
        """Return it with values of one wheel."""
        wheels = list(self.vehicle.wheels)
        wheels[place] = wheels[place].model_copy(update=values)
        return self.described(wheels=wheels)

    def with_readings(self, names: Sequence[str], factor: float) -> _Read:
        """Return it with some readings times a factor."""
        return replace(
            self, readings={**self.readings, **{name: self.readings[name] * factor for name in names}}
        )

    def without_speed(self, place: int) -> _Read:
        """Return it without the speed of one wheel."""
        speeds = tuple(None if k == place else name for k, name in enumerate(self.names.speeds))
        return replace(self, names=replace(self.names, speeds=speeds))

    def exchanged(self, first: int, second: int) -> _Read:
        """Return it with the readings of two wheels exchanged."""
        places = list(range(len(self.vehicle.wheels)))
        places[first], places[second] = second, first
        return replace(self, names=self._names_of(places))

    def of_wheels(self, places: Sequence[int]) -> _Read:
        """Return it with these wheels alone."""
        wheels = [self.vehicle.wheels[k] for k in places]
        return replace(self.described(wheels=wheels), names=self._names_of(places))

    def described(self, **changes: Any) -> _Read:
        """Return it with other keys of the description."""
        keys = {key: getattr(self.vehicle, key) for key in VehicleDescription.model_fields}
        return replace(self, vehicle=VehicleDescription(**{**keys, **changes}))

    def _names_of(self, places: Sequence[int]) -> WheelNames:
        speeds, steering = (
            tuple(names[k] for k in places) for names in (self.names.speeds, self.names.steering)
        )
        return replace(self.names, speeds=speeds, steering=steering)


def layout_findings(
    vehicle: VehicleDescription, names: WheelNames, readings: Mapping[str, Floats], t: Floats
) -> tuple[Finding, ...]:
    """Return what speaks against the description, or the readings, of a vehicle's wheels.

    Args:
        vehicle: a vehicle with wheels.
        names: of the readings.
        readings: by name [N], rad/s of speeds and rad of angles, NaN where there is none.
        t: stamps [N] s.
    """
    if len(t) < _ENOUGH:
        return ()
    there = np.isfinite(t)
    for name in names.all:
        there &= np.isfinite(readings[name])
    rows = np.flatnonzero(there)[-_MOST:]
    read = _Read(vehicle, names, {name: readings[name][rows] for name in names.all}, t[rows])
    turning = np.zeros(len(rows), np.bool_)
    for speed in names.speeds:
        turning |= False if speed is None else read.readings[speed] != 0.0
    if turning.sum() < _ENOUGH:
        return ()
    looked = [look(read) for look in (_still_hinge, _contradiction, _still_wheel)]
    found = sorted((each for each in looked if each is not None), key=lambda each: not each.spoils)
    return tuple(found[:1])  # the others would follow from the first


def _contradiction(read: _Read) -> Finding | None:
    share = read.disagreement()
    if not share > _SOME:
        return None
    least, likely = _explained(read, share)
    if not likely and not share > _LITTLE:
        return None
    return WheelLayout.found(
        f"the wheels contradict each other by {100.0 * share:.0f} % of their speeds: no body rolls like that",
        f"They agree to {100.0 * least:.1f} % where {', or where '.join(each.what for each in likely)}: "
        "correct that."
        if likely
        else "Compare the description with the robot: names, x and y, reversed, steer_reversed, units.",
        evidence=share,
        spoils=not all(each.harmless for each in likely) if likely else share > _MUCH,
    )


def _explained(read: _Read, share: float) -> tuple[float, list[_Mistake]]:
    """Return what is left of the disagreement by the mistakes that explain it best, and these."""
    for enough, mistakes in ((_SOME, _of_all), (_SOME, _of_size), (_LITTLE, _of_some), (_MUCH, _left_out)):
        tried = list(mistakes(read)) if share > enough else []
        left = [each.corrected.disagreement() for each in tried]
        least = min(filter(math.isfinite, left), default=math.inf)
        if least < _EXPLAINS * share:
            alike = [each for each, rest in zip(tried, left, strict=True) if rest <= _ALIKE * least]
            return least, alike[:4]
    return share, []


def _of_all(read: _Read) -> Iterator[_Mistake]:
    """Yield mistakes with the whole description."""
    names = read.names
    steering = [name for name in names.steering if name is not None]
    mirrored = read.with_each(lambda wheel: {"y": -wheel.y})
    yield _Mistake("left and right are exchanged (the signs of y)", mirrored)
    yield _Mistake(
        "front and rear are exchanged (the signs of x)", read.with_each(lambda wheel: {"x": -wheel.x})
    )
    if any(map(_rigid, read.vehicle.wheels)):
        sliding = read.with_each(lambda wheel: {"slides": wheel.slides or _rigid(wheel)})
        yield _Mistake(_SLIDES, sliding, harmless=True)
    if steering:
        turned = read.with_each(lambda wheel: {"steer_reversed": not wheel.steer_reversed})
        yield _Mistake("angles of steering count to the right (steer_reversed)", turned)
        yield from _in_degrees(read, "angles of steering are degrees", steering)
    if names.hinge is not None and read.vehicle.hinge is not None:
        hinge = read.vehicle.hinge
        ahead = hinge.model_copy(update={"x": -hinge.x})
        yield _Mistake("the hinge has the other sign of x", read.described(hinge=ahead))
        yield _Mistake(f"{names.hinge} counts to the right", read.with_readings([names.hinge], -1.0))
        yield from _in_degrees(read, f"{names.hinge} is in degrees", [names.hinge])


def _of_size(read: _Read) -> Iterator[_Mistake]:
    """Yield wheels of another size, whose speeds go with the others' by a factor."""
    for place, name in _driven(read).items():
        squares = [float(np.sum(read.with_readings([name], k).twists().squares)) for k in (0.0, 1.0, 2.0)]
        bend = squares[0] - 2.0 * squares[1] + squares[2]  # they are a parabola of the factor
        if not bend > 0.0:
            continue
        factor = 0.5 + (squares[0] - squares[1]) / bend
        if _LEAST_FACTOR < factor < _MOST_FACTOR:
            wheel = read.vehicle.wheels[place].name
            what = f"{wheel} turns {factor:.2f} times as far as it counts (its radius, ticks or gear)"
            yield _Mistake(what, read.with_readings([name], factor), harmless=True)


def _of_some(read: _Read) -> Iterator[_Mistake]:
    """Yield mistakes with one or two wheels."""
    wheels, driven = read.vehicle.wheels, _driven(read)
    for count in (1, 2):
        for some in combinations(driven, count) if len(driven) > _FEW_WHEELS * (count - 1) else ():
            turned = read
            for place in some:
                turned = turned.with_wheel(place, reversed=not wheels[place].reversed)
            names = " and ".join(wheels[place].name for place in some)
            yield _Mistake(f"{names} turn{'s' if count == 1 else ''} backwards (reversed)", turned)
    for first, second in combinations(range(len(wheels)), 2):
        if (wheels[first].steer is None) == (wheels[second].steer is None):
            pair = f"{wheels[first].name} and {wheels[second].name} are exchanged"
            yield _Mistake(pair, read.exchanged(first, second))
    for place, wheel in enumerate(wheels):
        angle = read.names.steering[place]
        if angle is not None:
            counted = read.with_wheel(place, steer_reversed=not wheel.steer_reversed)
            yield _Mistake(f"the steering of {wheel.name} counts to the right (steer_reversed)", counted)
            yield from _in_degrees(read, f"the steering of {wheel.name} is in degrees", [angle])


def _left_out(read: _Read) -> Iterator[_Mistake]:
    """Yield one of three or more speeds, and all that one wheel says."""
    wheels, driven = read.vehicle.wheels, _driven(read)
    for place in driven if len(driven) > _FEW_WHEELS else ():
        without = read.without_speed(place)
        yield _Mistake(f"the speed of {wheels[place].name} is wrong or missing", without)
        if wheels[place].steer is not None:
            others = read.of_wheels([k for k in range(len(wheels)) if k != place])
            yield _Mistake(f"nothing that {wheels[place].name} says is read", others)


def _driven(read: _Read) -> dict[int, str]:
    """Return the names of the speeds that are read, by the places of their wheels."""
    return {place: name for place, name in enumerate(read.names.speeds) if name is not None}


def _rigid(wheel: WheelDescription) -> bool:
    """Say whether a wheel is described as one that neither steers nor rolls nor slides across."""
    return wheel.steer is None and wheel.roller is None and not wheel.slides


def _in_degrees(read: _Read, what: str, names: Sequence[str]) -> Iterator[_Mistake]:
    if max(float(np.max(np.abs(read.readings[name]))) for name in names) > _FEW_DEGREES:
        yield _Mistake(what, read.with_readings(names, _DEGREES))


def _still_hinge(read: _Read) -> Finding | None:
    name = read.names.hinge
    if name is None:
        return None
    omega = _turns_ahead(read)
    turns = np.isfinite(omega) & (np.abs(omega) > _TURNS)
    if not turns.any():
        return None
    spread = float(np.std(omega[turns]))
    for mine, seconds in _still(read, name, turns):
        if float(np.std(omega[mine])) > _VARIES * spread:
            return StillHinge.found(
                f"{name} stays at {read.readings[name][mine[0]]:.3g} rad for {seconds:.0f} s in which the "
                "vehicle turns this way and that",
                "Repair the sensor of the hinge, or describe the wheels on one side of it alone.",
                evidence=seconds,
            )
    return None


def _still_wheel(read: _Read) -> Finding | None:
    speeds = _driven(read).values()
    for name in speeds if len(speeds) > _FEW_WHEELS else ():
        others = np.array([read.readings[other] for other in speeds if other != name])
        spread = float(np.cov(others).trace())
        for mine, seconds in _still(read, name, np.abs(others).sum(axis=0) > 0.0):
            along, across = np.linalg.eigvalsh(np.cov(others[:, mine]))[:-3:-1].tolist()
            if across > _SIDES * along and along > _VARIES**2 * spread:
                return StillWheel.found(
                    f"{name} stays at {read.readings[name][mine[0]]:.3g} rad/s for {seconds:.0f} s in which "
                    "the other wheels turn this way and that",
                    "Repair its encoder, or describe the other wheels alone.",
                    evidence=seconds,
                )
    return None


def _still(read: _Read, name: str, turns: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.int64], float]]:
    """Yield the rows of the vehicle's turning in which a reading stays for long, and for how long [s]."""
    values = read.readings[name]
    steps = np.clip(np.diff(read.t, append=read.t[-1:]), 0.0, 1.0)
    for rows in np.split(np.arange(len(values)), np.flatnonzero(np.diff(values) != 0.0) + 1):
        mine = rows[turns[rows]]
        seconds = float(np.sum(steps[mine]))
        if seconds >= _STILL:
            yield mine, seconds


def _turns_ahead(read: _Read) -> Floats:
    """Return the yaw rate [N] that the wheels before the hinge alone tell; not a number where they do not."""
    ahead = [k for k, wheel in enumerate(read.vehicle.wheels) if not wheel.behind_hinge]
    try:
        alone = read.of_wheels(ahead).described(hinge=None)
        return replace(alone, names=replace(alone.names, hinge=None)).twists().omega
    except SlipwiseError:
        return np.full(len(read.t), math.nan)
