# SPDX-License-Identifier: Apache-2.0
"""How much of what is commanded arrives at the wheels and at the body, as windows of the log say it.

No model is asked: the mean rates of windows of about 1.5 s are fitted by those of the commands in the same
window, the two before it and the two after it. The sum of the coefficients is what arrives in the end,
whatever lag, delay and offset of clocks there are. Its standard deviation is the scatter where a tenth of the
windows is left out in turn, and the difference that the oldest window makes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.models.schema import AxisShares, Share, Shares

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_TAPS = (-2, -1, 0, 1, 2)  # windows whose inputs act in a window: means are of either side, and stamps late
_NOW = _TAPS.index(0)
_FEWEST = 20  # windows that say something
_BLOCKS = 10  # that are left out in turn
_KNOWN_PART = 0.9  # of a window's time, an input must be known
_SAME = 1e-3  # s between the end of a window and the start of the next
_DRIVEN = 0.05  # of the largest command, below which a window says nothing of small ones
_CLEAR, _LARGE = 3.0, 0.1  # standard deviations, and part of the share, by which small commands differ
_LARGEST = 100.0  # times what is commanded; more is of commands that are as good as none
_TINY, _HUGE = 1e-6, 1e6  # m/s or rad/s; no robot is commanded less, or drives more
_RUN, _START, _DURATION, _DISTANCE, _COURSE, _TURN, _START_YAW = 0, 1, 3, 4, 5, 6, 8
_COMMANDS, _WHEELS = 9, 13  # columns of forward, sideways, rotation, known


@dataclass(frozen=True, eq=False)
class _Fit:
    """Rates that come out of inputs, in M windows."""

    inputs: Floats  # [M, taps] in the window and its neighbours
    outputs: Floats  # [M]
    parts: Ints  # [M] the tenth of the time

    def __len__(self) -> int:
        return len(self.outputs)

    def only(self, kept: NDArray[np.bool_]) -> _Fit:
        return _Fit(self.inputs[kept], self.outputs[kept], self.parts[kept])

    def coefficients(self) -> Floats:
        return np.asarray(np.linalg.lstsq(self.inputs, self.outputs, rcond=None)[0], dtype=np.float64)

    def scatter(self, number: Callable[[_Fit], float]) -> float:
        """Return the standard deviation of a number, by leaving a tenth of the windows out in turn."""
        left = [number(self.only(self.parts != part)) for part in range(_BLOCKS)]
        return float(np.sqrt((_BLOCKS - 1) * np.var(left)))


def shares_of(rows: Floats, *, sensor_y: float = 0.0, sensor_yaw: float = 0.0) -> Shares | None:
    """Return the shares that arrive; None where too few windows say it.

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        sensor_y: how far to the left the pose sensor is known to sit [m].
        sensor_yaw: how it is known to be turned [rad].
    """
    if len(rows) < _FEWEST:
        return None
    ahead, turned = _moved(rows, sensor_y, sensor_yaw)
    speed, yaw_rate = _axis(rows, ahead, 0), _axis(rows, turned, 2)
    return Shares(speed=speed, yaw_rate=yaw_rate) if speed or yaw_rate else None


def commanded_to_body(
    rows: Floats, *, sensor_y: float = 0.0, sensor_yaw: float = 0.0
) -> dict[str, tuple[Floats, Floats]]:
    """Return what is there of commands in each window, and what the body does, by axis; empty if too few are.

    Commands are those of the window and its neighbours, weighted as they act; a picture of them against the
    body shows dead bands and whatever is not in proportion. Arguments are those of `shares_of`.
    """
    if len(rows) < _FEWEST:
        return {}
    found, duration = {}, rows[:, _DURATION]
    ahead, turned = _moved(rows, sensor_y, sensor_yaw)
    for axis, body, column in (("speed", ahead, 0), ("yaw_rate", turned, 2)):
        fit = _fit(rows[:, _COMMANDS + column] / duration, body / duration, _places(rows, _COMMANDS))
        gain = 0.0 if _share(fit) is None else _gain(fit)
        if gain != 0.0:
            found[axis] = (fit.inputs @ (fit.coefficients() / gain), fit.outputs)
    return found


def _moved(rows: Floats, sensor_y: float, sensor_yaw: float) -> tuple[Floats, Floats]:
    """Return the way ahead [m] and the turn [rad] of the body in each window."""
    half = 0.5 * rows[:, _TURN]
    heading = rows[:, _COURSE] - (rows[:, _START_YAW] - sensor_yaw) - half
    arc = rows[:, _DISTANCE] / np.sinc(half / np.pi)
    return arc * np.cos(heading) + sensor_y * rows[:, _TURN], rows[:, _TURN]


def _axis(rows: Floats, body: Floats, column: int) -> AxisShares | None:
    duration = rows[:, _DURATION]
    commands, wheels, moved = rows[:, _COMMANDS + column], rows[:, _WHEELS + column], body
    commands, wheels, moved = commands / duration, wheels / duration, moved / duration
    commanded, rolled = _places(rows, _COMMANDS), _places(rows, _WHEELS)
    to_body = _fit(commands, moved, commanded)
    arrives = _share(to_body)
    if arrives is None:
        return None
    return AxisShares(
        windows=len(to_body),
        arrives=arrives,
        wheels=_share(_fit(commands, wheels, np.intersect1d(commanded, rolled))),
        floor=_share(_fit(wheels, moved, rolled)),
        **_out_of_proportion(to_body),
    )


def _places(rows: Floats, first: int) -> Ints:
    """Return the windows that have neighbours, in all of which the input is known."""
    known = rows[:, first + 3] > _KNOWN_PART * rows[:, _DURATION]
    ends = rows[:, _START] + rows[:, _DURATION]
    follows = np.zeros(len(rows), dtype=np.bool_)
    follows[1:] = (rows[1:, _RUN] == rows[:-1, _RUN]) & (np.abs(rows[1:, _START] - ends[:-1]) < _SAME)
    places = np.arange(-_TAPS[0], len(rows) - _TAPS[-1])
    good = [known[places + tap] for tap in _TAPS] + [follows[places + tap] for tap in _TAPS[1:]]
    found: Ints = places[np.logical_and.reduce(good)]
    return found


def _fit(inputs: Floats, outputs: Floats, places: Ints) -> _Fit:
    acting, acted = np.column_stack([inputs[places + tap] for tap in _TAPS]), outputs[places]
    sane = (np.abs(acting) < _HUGE).all(axis=1) & (np.abs(acted) < _HUGE)
    return _Fit(acting[sane], acted[sane], np.arange(sane.sum()) * _BLOCKS // max(int(sane.sum()), 1))


def _share(fit: _Fit) -> Share | None:
    if len(fit) < _FEWEST or not np.abs(fit.inputs).max() > _TINY:
        return None
    value = _gain(fit)
    if not abs(value) < _LARGEST:
        return None
    fewer = value - _gain(replace(fit, inputs=fit.inputs[:, 1:]))  # what the oldest commands make of it
    return Share(value=value, std=float(np.hypot(fit.scatter(_gain), fewer)))


def _gain(fit: _Fit) -> float:
    return float(fit.coefficients().sum())


def _out_of_proportion(fit: _Fit) -> dict[str, Any]:
    """Return the shares of small and large commands, and of either side, where they clearly differ."""
    size = np.abs(fit.inputs[:, _NOW])
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


def _apart(fit: _Fit, choose: Callable[[Floats], NDArray[np.bool_]]) -> tuple[Share, Share] | None:
    """Return the shares of commands that are not chosen and that are; None unless they clearly differ."""
    now = fit.inputs[:, _NOW]
    driven, chosen = np.abs(now) > _DRIVEN * np.abs(now).max(), choose(now)
    if min((driven & chosen).sum(), (driven & ~chosen).sum()) < _FEWEST:
        return None

    def difference(some: _Fit) -> float:
        return _difference(some, choose(some.inputs))

    def share(some: _Fit, *, chosen: bool) -> float:
        size = np.square(some.inputs)
        weight = float((size * (choose(some.inputs) != chosen)).sum()) / max(float(size.sum()), _TINY**2)
        return _gain(some) + weight * (difference(some) if chosen else -difference(some))

    values = [share(fit, chosen=which) for which in (False, True)]
    least = max(_CLEAR * fit.scatter(difference), _LARGE * max(map(abs, values)))
    if abs(values[1] - values[0]) < least:
        return None
    stds = [fit.scatter(partial(share, chosen=which)) for which in (False, True)]
    return Share(value=values[0], std=stds[0]), Share(value=values[1], std=stds[1])


def _difference(fit: _Fit, chosen: NDArray[np.bool_]) -> float:
    """Return by how much more of the chosen commands arrives.

    What acts of the chosen commands has a coefficient of its own, and each tenth of the time a share of its
    own, so that another ground is no difference.
    """
    whole = fit.coefficients()
    if not abs(whole.sum()) > _TINY:
        return 0.0
    acts = whole / whole.sum()
    own = (fit.parts[:, None] == np.arange(_BLOCKS)) * (fit.inputs @ acts)[:, None]
    columns = np.column_stack(((fit.inputs * chosen) @ acts, np.delete(fit.inputs, _NOW, axis=1), own))
    return float(np.linalg.lstsq(columns, fit.outputs, rcond=None)[0][0])
