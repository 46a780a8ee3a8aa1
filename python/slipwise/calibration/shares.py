# SPDX-License-Identifier: Apache-2.0
"""How much of what is commanded arrives at the wheels and at the body, as windows of the log say it.

No model is asked: the mean rates of windows of about 1.5 s are fitted by those of the commands in the same
window, the two before it and the two after it. The sum of the coefficients is what arrives in the end,
whatever lag, delay and offset of clocks there are. Its standard deviation is the scatter where a tenth of the
windows is left out in turn, and the difference that the oldest window makes. Curves shorten nothing: the way
is that along the heading. Of positions alone windows say nothing of speed in which the turning changes much.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.rate_fits import BLOCKS, NOW, TAPS, Fit, Floats, Ints, SquareFit
from slipwise.models.schema import AxisShares, Share, Shares

Bools = NDArray[np.bool_]

_FEWEST = 20  # windows that say something
_KNOWN_PART = 0.9  # of a window's time, an input must be known
_DRIVEN = 0.05  # of the largest command, below which a window says nothing of small ones
_CLEAR, _LARGE = 3.0, 0.1  # standard deviations, and part of the share, by which small commands differ
_LARGEST = 100.0  # times what is commanded; more is of commands that are as good as none
_TINY, _HUGE = 1e-6, 1e6  # m/s or rad/s; no robot is commanded less, or drives more
_BEND = 1.0  # rad that a window may turn, and turn more than its neighbours, where positions tell speeds
_WRAPS = 1.2  # rad by which turns in windows scatter, from which on many pass for turns the other way
_ALONE = 0.05  # of the squares of speeds; where turns explain the rest, driving ahead is not told from them
_COMMANDS, _WHEELS = 9, 13  # columns of forward, sideways, rotation, known
_FORWARD, _SIDEWAYS, _ROTATION = 0, 1, 2
RUN, START, DURATION, DISTANCE, TURN, AHEAD, LEFT = 0, 1, 3, 4, 6, 17, 18  # columns of `_core` rows
SAME = 1e-3  # s between the end of a window and the start of the next
_SHORTEST = 0.5  # of the way, below which a chord does not tell it
_NODES, _WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(8))


@dataclass(frozen=True)
class PoseSensor:
    """What is known of what measures poses."""

    y: float = 0.0  # m, how far to the left it sits
    yaw: float = 0.0  # rad, how it is turned
    positions: bool = False  # it measures no headings


_PLAIN = PoseSensor()


@dataclass(frozen=True)
class Answer:
    """What the body does of one axis of an input."""

    share: Share
    explained: float  # part of the squares of its rates
    varied: float  # m/s or rad/s, standard deviation of the input


def shares_of(rows: Floats, sensor: PoseSensor = _PLAIN) -> Shares | None:
    """Return the shares that arrive; None where too few windows say it.

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        sensor: what is known of the pose sensor.
    """
    if len(rows) < _FEWEST:
        return None
    axes = _axes(rows, sensor)
    lost = sensor.positions and _lost(rows, axes["yaw_rate"])
    speed, yaw_rate = _axis(rows, axes["speed"]), None if lost else _axis(rows, axes["yaw_rate"])
    return Shares(speed=speed, yaw_rate=yaw_rate) if speed or yaw_rate else None


def answers_of(rows: Floats, input_name: str, sensor: PoseSensor = _PLAIN) -> dict[str, Answer]:
    """Return what the body does of an input, by axis; of axes of which enough windows say it.

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        input_name: "command" or "wheel".
        sensor: what is known of the pose sensor.
    """
    if len(rows) < _FEWEST:
        return {}
    found = {}
    for name, axis in _axes(rows, sensor).items():
        fit = axis.to_body(_COMMANDS if input_name == "command" else _WHEELS)
        share = _share(fit)
        if share is not None:
            found[name] = Answer(share, fit.explained(), float(np.std(fit.inputs[:, NOW])))
    return found


def commanded_to_body(rows: Floats, sensor: PoseSensor = _PLAIN) -> dict[str, tuple[Floats, Floats]]:
    """Return what is there of commands in each window, and what the body does, by axis; empty if too few are.

    Commands are those of the window and its neighbours, weighted as they act; a picture of them against the
    body shows dead bands and whatever is not in proportion. Arguments are those of `shares_of`.
    """
    if len(rows) < _FEWEST:
        return {}
    found = {}
    for name, axis in _axes(rows, sensor).items():
        fit = axis.to_body(_COMMANDS)
        if _share(fit) is not None and fit.gain() != 0.0:
            found[name] = (fit.inputs @ (fit.coefficients() / fit.gain()), fit.rates_out())
    return found


@dataclass(frozen=True)
class _Axis:
    """One axis of the body: which column of inputs moves it, and how they are fitted to what it did."""

    column: int
    to_body: Callable[[int], Fit]  # of the commands or the wheels, by their first column


def _axes(rows: Floats, sensor: PoseSensor) -> dict[str, _Axis]:
    duration = rows[:, DURATION]
    places = {first: _places(rows, first) for first in (_COMMANDS, _WHEELS)}
    turned = {first: rows[:, TURN] / duration - _veer(rows, first, places[first]) for first in places}

    def turns(first: int) -> Fit:
        return _fit(rows[:, first + _ROTATION] / duration, turned[first], places[first])

    ahead = (ways_ahead(rows, sensor.yaw) + sensor.y * rows[:, TURN]) / duration

    def speeds(first: int) -> Fit:
        if sensor.positions:
            return _speeds_of_positions(rows, turns, sensor.y, first)
        return _fit(rows[:, first + _FORWARD] / duration, ahead, places[first])

    return {"speed": _Axis(_FORWARD, speeds), "yaw_rate": _Axis(_ROTATION, turns)}


def _speeds_of_positions(rows: Floats, turns: Callable[[int], Fit], sensor_y: float, first: int) -> SquareFit:
    """Fit inputs to squares of speeds; how far a window turned is what comes of the inputs' turns.

    A sensor ahead of the body's centre swings out in turns by an unknown way, whose squares add.
    Where a window turns far, or the turning changes much, a chord tells no way: such windows are left out.
    """
    duration, places, follows = rows[:, DURATION], _places(rows, first), follows_before(rows)
    acting = np.column_stack([rows[places + tap, first + _ROTATION] for tap in TAPS])
    turn = np.zeros(len(rows))
    turn[places] = acting @ turns(first).coefficients()
    shape = np.abs(chord_per_way(turn, duration, follows))
    bent = np.maximum(np.abs(turn - np.roll(turn, 1)), np.abs(turn - np.roll(turn, -1)))
    little = (bent < _BEND) & (np.abs(rows[:, first + _ROTATION]) < _BEND)
    squares = np.where(little, np.square(rows[:, DISTANCE] / shape / duration), np.nan)
    sane = _sane(rows[:, first] / duration, squares, places)
    rates = (turn / duration)[sane]
    plain = _fit(rows[:, first + _FORWARD] / duration, squares, sane)
    swings = np.column_stack((rates, (rows[:, first + _SIDEWAYS] / duration)[sane]))
    return SquareFit(
        plain.inputs, plain.outputs, plain.parts, beside=-sensor_y * rates, adding=np.square(swings)
    )


def _veer(rows: Floats, first: int, places: Ints) -> Floats:
    """Return yaw rates [N] rad/s that come of driving ahead: a robot that veers turns alike to both sides."""
    rates = rows[:, [first + _FORWARD, first + _ROTATION, TURN]] / rows[:, [DURATION]]
    ahead, given, turned = rates.T
    places = _sane(given, turned, _sane(ahead, turned, places))
    beside = np.column_stack([given[places + tap] for tap in TAPS] + [np.abs(given[places])])
    alone = ahead[places] - beside @ np.linalg.lstsq(beside, ahead[places], rcond=None)[0]
    if np.square(alone).sum() <= _ALONE * np.square(ahead[places]).sum():
        return np.zeros(len(rows))  # driving ahead cannot be told from turning, as on one circle
    columns = np.column_stack((ahead[places], ahead[places - 1], beside))
    now, before = np.linalg.lstsq(columns, turned[places], rcond=None)[0][:2]
    veer: Floats = now * ahead + before * np.roll(ahead, 1)
    return veer


def _lost(rows: Floats, turning: _Axis) -> bool:
    """Whether courses of positions scatter so far that turns between them come out as turns the other way."""
    fit = turning.to_body(_COMMANDS)
    if not len(fit):
        return False
    left = (fit.outputs - fit.inputs @ fit.coefficients()) * float(np.median(rows[:, DURATION]))
    return bool(np.sqrt(np.square(left).mean()) > _WRAPS)


def _axis(rows: Floats, axis: _Axis) -> AxisShares | None:
    to_body = axis.to_body(_COMMANDS)
    arrives = _share(to_body)
    if arrives is None:
        return None
    commands, wheels = (rows[:, first + axis.column] / rows[:, DURATION] for first in (_COMMANDS, _WHEELS))
    both = np.intersect1d(_places(rows, _COMMANDS), _places(rows, _WHEELS))
    return AxisShares(
        windows=len(to_body),
        arrives=arrives,
        wheels=_share(_fit(commands, wheels, both)),
        floor=_share(axis.to_body(_WHEELS)),
        **({} if isinstance(to_body, SquareFit) else _out_of_proportion(to_body)),
    )


def _places(rows: Floats, first: int) -> Ints:
    """Return the windows that have neighbours, in all of which the input is known."""
    known = rows[:, first + 3] > _KNOWN_PART * rows[:, DURATION]
    follows = follows_before(rows)
    places = np.arange(-TAPS[0], len(rows) - TAPS[-1])
    good = [known[places + tap] for tap in TAPS] + [follows[places + tap] for tap in TAPS[1:]]
    found: Ints = places[np.logical_and.reduce(good)]
    return found


def _sane(inputs: Floats, outputs: Floats, places: Ints) -> Ints:
    """Return those of the windows in which inputs and outputs are numbers of a robot."""
    acting = np.column_stack([inputs[places + tap] for tap in TAPS])
    return places[(np.abs(acting) < _HUGE).all(axis=1) & (np.abs(outputs[places]) < _HUGE)]


def _fit(inputs: Floats, outputs: Floats, places: Ints) -> Fit:
    sane = _sane(inputs, outputs, places)
    acting = np.column_stack([inputs[sane + tap] for tap in TAPS])
    return Fit(acting, outputs[sane], np.arange(len(sane)) * BLOCKS // max(len(sane), 1))


def _share(fit: Fit) -> Share | None:
    if len(fit) < _FEWEST or not np.abs(fit.inputs).max() > _TINY:
        return None
    value = fit.gain()
    if not abs(value) < _LARGEST:
        return None
    fewer = value - fit.without_oldest().gain()  # what the oldest commands make of it
    return Share(value=value, std=float(np.hypot(fit.scatter(Fit.gain), fewer)))


def _out_of_proportion(fit: Fit) -> dict[str, Any]:
    """Return the shares of small and large commands, and of either side, where they clearly differ."""
    size = np.abs(fit.inputs[:, NOW])
    driven = size > _DRIVEN * size.max()
    middle = float(np.median(size[driven])) if driven.any() else 0.0
    sizes = _apart(fit, lambda inputs: np.abs(inputs) > middle)
    sides = _apart(fit, lambda inputs: inputs > 0.0)
    found: dict[str, Any] = {}
    if sizes is not None:
        found |= {"below": middle, "small": sizes[0], "large": sizes[1]}
    if sides is not None:
        found |= {"backward": sides[0], "forward": sides[1]}
    return found


def _apart(fit: Fit, choose: Callable[[Floats], NDArray[np.bool_]]) -> tuple[Share, Share] | None:
    """Return the shares of commands that are not chosen and that are; None unless they clearly differ."""
    now = fit.inputs[:, NOW]
    driven, chosen = np.abs(now) > _DRIVEN * np.abs(now).max(), choose(now)
    if min((driven & chosen).sum(), (driven & ~chosen).sum()) < _FEWEST:
        return None

    def difference(some: Fit) -> float:
        return _difference(some, choose(some.inputs))

    def share(some: Fit, *, chosen: bool) -> float:
        size = np.square(some.inputs)
        weight = float((size * (choose(some.inputs) != chosen)).sum()) / max(float(size.sum()), _TINY**2)
        return some.gain() + weight * (difference(some) if chosen else -difference(some))

    values = [share(fit, chosen=which) for which in (False, True)]
    least = max(_CLEAR * fit.scatter(difference), _LARGE * max(map(abs, values)))
    if abs(values[1] - values[0]) < least:
        return None
    stds = [fit.scatter(partial(share, chosen=which)) for which in (False, True)]
    return Share(value=values[0], std=stds[0]), Share(value=values[1], std=stds[1])


def _difference(fit: Fit, chosen: NDArray[np.bool_]) -> float:
    """Return by how much more of the chosen commands arrives.

    What acts of the chosen commands has a coefficient of its own, and each tenth of the time a share of its
    own, so that another ground is no difference.
    """
    whole = fit.coefficients()
    if not abs(whole.sum()) > _TINY:
        return 0.0
    acts = whole / whole.sum()
    own = (fit.parts[:, None] == np.arange(BLOCKS)) * (fit.inputs @ acts)[:, None]
    columns = np.column_stack(((fit.inputs * chosen) @ acts, np.delete(fit.inputs, NOW, axis=1), own))
    return float(np.linalg.lstsq(columns, fit.outputs, rcond=None)[0][0])


def chord_per_way(turn: Floats, duration: Floats, follows: Bools) -> NDArray[np.complex128]:
    """Return chords over ways [N], seen from the first heading; NaN where the chord is too short to tell.

    A chord is shorter than the way, most where the turning changes within a window: the heading follows a
    cubic, whose slopes at both ends are the mean yaw rates of either side.
    """
    rate = turn / duration
    second = np.flatnonzero(follows)
    begin, end = rate.copy(), rate.copy()
    begin[second] = end[second - 1] = 0.5 * (rate[second - 1] + rate[second])
    s = (0.5 + _NODES)[:, None]
    bends = s * (1.0 - s) ** 2 * begin - s**2 * (1.0 - s) * end
    yaw = s**2 * (3.0 - 2.0 * s) * turn + bends * duration
    shape: NDArray[np.complex128] = (_WEIGHTS[:, None] * np.exp(1j * yaw)).sum(axis=0)
    return np.where(np.abs(shape) < _SHORTEST, np.nan, shape)


def follows_before(rows: Floats) -> Bools:
    """Say which windows [M] begin where the one before ends."""
    ends = rows[:, START] + rows[:, DURATION]
    follows = np.zeros(len(rows), dtype=np.bool_)
    follows[1:] = (rows[1:, RUN] == rows[:-1, RUN]) & (np.abs(rows[1:, START] - ends[:-1]) < SAME)
    return follows


def ways_ahead(rows: Floats, sensor_yaw: float) -> Floats:
    """Return how far the pose sensor, turned by `sensor_yaw` [rad], went along the robot's heading [m]."""
    ahead: Floats = np.cos(sensor_yaw) * rows[:, AHEAD] - np.sin(sensor_yaw) * rows[:, LEFT]
    return ahead
