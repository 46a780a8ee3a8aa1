# SPDX-License-Identifier: Apache-2.0
"""Finds sideways speeds that poses do not follow: of another sign, axis or unit, without one, or left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.plausibility import correlation
from slipwise.logs.findings.robust_fit import robust_fit

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen
    from slipwise.logs.log import Floats

_ENOUGH = 30  # windows
_LEAST = 0.05  # [m] by the inputs
_MOST_TURN = 0.8  # [rad] of the poses, on which the ends of a way tell its direction on the robot
_MOST_ROTATION = 1.2  # [rad] by the inputs
_EXPLAINED, _NOT_EXPLAINED = 0.5, 0.3  # parts of the squares
_BY_SIDEWAYS = 0.5  # of the root mean square of ways to the left, which the sideways speed gives
_FAR = 0.4  # of the usual way ahead, to a side that nothing tells of; real logs have 0.15, hills 0.3
_UNIT = 3.0  # times as much, or as little, as of the speed ahead
_SO = 0.5  # correlation of sizes, of a speed without its sign


class SidewaysSpeed(Check):
    """Sideways speeds that the robot does not move by."""

    kind, family = "sideways-speed", "signs and units"
    means = "the sideways speed has another sign, axis or unit, no sign, or is not in the log"
    shows = (
        "what poses move ahead and to the left, fitted to both speeds: mirrored, 3 times off, not explained"
    )
    cure = "`cmd_vy`, `odo_vy`, `linear.y` in m/s to the left; or the headings are wrong"

    def look(self, seen: Seen) -> Finding | None:
        """Fit what the poses move ahead and to the left to what the inputs drive and turn."""
        ways = _ways(seen)
        if seen.positions or ways is None:
            return None
        ahead, left = ways.fitted
        if ahead.explained < _EXPLAINED:
            return None
        if left.explained > _NOT_EXPLAINED:
            return self._of_gains(ways, seen.words.name)
        return self._lost_sign(ways, seen.words.name) or self._left_out(ways, seen.words.name)

    def _lost_sign(self, ways: _Ways, name: str) -> Finding | None:
        """Compare how far poses and inputs go sideways, whichever way."""
        sizes = [np.abs(each) - np.abs(each).mean() for each in (ways.left, ways.sideways)]
        if not ways.sideways.any() or correlation(*sizes) < _SO:
            return None
        return self.found(
            f"the poses move as far sideways as the {name} say, but to either side: the sideways speed lost "
            "its sign",
            "Record the sideways speed with its sign: to the left is positive.",
            evidence=correlation(*sizes),
        )

    def _left_out(self, ways: _Ways, name: str) -> Finding | None:
        """Look how far poses go to sides that no input tells of."""
        usual, off = float(np.median(np.abs(ways.ahead))), float(np.median(np.abs(ways.left - ways.by_fit)))
        if off < max(_FAR * usual, _LEAST):
            return None
        return self.found(
            f"the poses move {off / usual:.1f} times as far to their sides as ahead, which no sideways speed "
            f"of the {name} tells of",
            "Record the sideways speed of a robot that drives sideways; of another, look at its headings.",
            evidence=off / usual,
        )

    def _of_gains(self, ways: _Ways, name: str) -> Finding | None:
        """Look at four gains that explain the ways."""
        ahead, left = ways.fitted
        by_sideways = max(abs(left.sideways), abs(left.forward)) * _size(ways.sideways)
        if not ways.sideways.any() or by_sideways < _BY_SIDEWAYS * _size(ways.left):
            return None
        gains = np.array([[ahead.forward, ahead.sideways], [left.forward, left.sideways]])
        mirrored = float(np.linalg.det(gains))
        if mirrored < 0.0:
            own, other = abs(gains[0, 0] * gains[1, 1]), abs(gains[0, 1] * gains[1, 0])
            which = "forward" if gains[0, 0] < 0.0 else "sideways"
            what = f"the sign of the {which} speed is flipped" if own > other else "both speeds are swapped"
            return self.found(
                f"the poses move as the {name} say in a mirror: {what}",
                "Forwards is positive, and to the left is positive (REP-103).",
                evidence=mirrored,
            )
        times = abs(gains[1, 1]) / abs(gains[0, 0])
        across = abs(gains[0, 1]) * _size(ways.sideways) > abs(gains[0, 0]) * _size(ways.forward)
        if 1.0 / _UNIT < times < _UNIT or across:  # a frame that is turned
            return None
        return self.found(
            f"the poses move {gains[1, 1]:.2g} times as far sideways as the {name} say, and "
            f"{gains[0, 0]:.2g} times as far ahead: the sideways speed is in another unit",
            "Give both speeds in m/s.",
            evidence=times,
        )


@dataclass(frozen=True)
class _Fitted:
    forward: float  # m for each metre that is driven ahead by the inputs
    sideways: float  # the same, of what is driven to the left
    explained: float  # part of the squares


@dataclass(frozen=True, eq=False)
class _Ways:
    """What poses move ahead and to the left on the robot, in N windows."""

    ahead: Floats  # [N] m
    left: Floats  # [N] m
    by_fit: Floats  # [N] m to the left, by what the inputs drive and turn
    forward: Floats  # [N] m, by the inputs
    sideways: Floats  # [N] m, the same
    fitted: tuple[_Fitted, _Fitted]  # ahead, left


def _ways(seen: Seen) -> _Ways | None:
    """Return them where there are enough of such windows."""
    w = seen.windows
    near = (np.abs(w.turn) < _MOST_TURN) & (np.abs(w.rotation) < _MOST_ROTATION)
    near &= np.hypot(w.forward, w.sideways) > _LEAST
    if int(near.sum()) < _ENOUGH:
        return None
    way = (w.distance * np.exp(1j * w.course_ahead(seen.sensor_yaw)))[near]
    inputs = np.column_stack((w.forward, w.sideways, w.rotation))[near]
    fits = [robust_fit(inputs, each) for each in (way.real, way.imag)]
    parts = [
        1.0 - float(np.sum((each - inputs @ gains) ** 2) / max(float(np.sum(each**2)), 1e-12))
        for each, gains in zip((way.real, way.imag), fits, strict=True)
    ]
    return _Ways(
        way.real,
        way.imag,
        inputs @ fits[1],
        inputs[:, 0],
        inputs[:, 1],
        (
            _Fitted(float(fits[0][0]), float(fits[0][1]), parts[0]),
            _Fitted(float(fits[1][0]), float(fits[1][1]), parts[1]),
        ),
    )


def _size(values: Floats) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))
