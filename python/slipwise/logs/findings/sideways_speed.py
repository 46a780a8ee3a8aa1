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
        ahead, left = ways.explained
        if ahead < _EXPLAINED:
            return None
        crossed = ways.crossed if ways.sideways else 0.0
        if crossed > _EXPLAINED:
            name = seen.words.name
            return self.found(
                f"the poses move to the left as the {name} turn, and turn as these move to the left",
                "Exchange both columns, or two wheels of the description.",
                evidence=crossed,
            )
        if left > _NOT_EXPLAINED:
            return self._of_gains(ways, seen.words.name)
        return self._lost_sign(ways, seen.words.name) or self._left_out(ways, seen.words.name)

    def _lost_sign(self, ways: _Ways, name: str) -> Finding | None:
        """Compare how far poses and inputs go sideways, whichever way."""
        sizes = [np.abs(each) - np.abs(each).mean() for each in (ways.moved[:, 1], ways.given[:, 1])]
        alike = correlation(*sizes) if ways.sideways else 0.0
        if alike < _SO:
            return None
        return self.found(
            f"the poses move as far sideways as the {name} say, but to either side: the sideways speed lost "
            "its sign",
            "Record the sideways speed with its sign: to the left is positive.",
            evidence=alike,
        )

    def _left_out(self, ways: _Ways, name: str) -> Finding | None:
        """Look how far poses go to sides that no input tells of."""
        usual = float(np.median(np.abs(ways.moved[:, 0])))
        off = float(np.median(np.abs(ways.left_over[:, 1])))
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
        gains = ways.gains[:2].T  # of ways ahead and to the left, by what is driven ahead and to the left
        forward, sideways = _sizes(ways.given[:, :2])
        if not ways.sideways or np.abs(gains[1]).max() * sideways < _BY_SIDEWAYS * _sizes(ways.moved)[1]:
            return None
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
        across = abs(gains[0, 1]) * sideways > abs(gains[0, 0]) * forward
        if 1.0 / _UNIT < times < _UNIT or across:  # a frame that is turned
            return None
        return self.found(
            f"the poses move {gains[1, 1]:.2g} times as far sideways as the {name} say, and "
            f"{gains[0, 0]:.2g} times as far ahead: the sideways speed is in another unit",
            "Give both speeds in m/s.",
            evidence=times,
        )


@dataclass(frozen=True, eq=False)
class _Ways:
    """What poses move ahead and to the left on the robot in N windows, fitted to the inputs."""

    moved: Floats  # [N, 2] m
    turned: Floats  # [N] rad
    given: Floats  # [N, 3] m and rad: forward, sideways, rotation
    gains: Floats  # [3, 2]

    @property
    def sideways(self) -> bool:
        """Whether the inputs drive sideways."""
        return bool(self.given[:, 1].any())

    @property
    def crossed(self) -> float:
        """Which part of ways to the left the rotation gives, and of turns the sideways speed: the smaller.

        It is zero where either gives its own.
        """
        gains = np.column_stack((self.gains[1:, 1], robust_fit(self.given, self.turned)[0][1:]))
        wanted = _sizes(np.column_stack((self.moved[:, 1], self.turned)))
        parts = np.abs(gains) * np.divide.outer(_sizes(self.given[:, 1:]), np.maximum(wanted, 1e-12))
        return float(min(parts[1, 0], parts[0, 1])) if max(parts[0, 0], parts[1, 1]) < _NOT_EXPLAINED else 0.0

    @property
    def left_over(self) -> Floats:
        """What the fit does not give [N, 2] m."""
        return np.asarray(self.moved - self.given @ self.gains)

    @property
    def explained(self) -> tuple[float, float]:
        """Which part of the squares ahead and to the left the fit gives."""
        left, all_ = (np.sum(each**2, axis=0) for each in (self.left_over, self.moved))
        ahead, aside = (1.0 - left / np.maximum(all_, 1e-12)).tolist()
        return ahead, aside


def _ways(seen: Seen) -> _Ways | None:
    """Return them where there are enough of such windows."""
    w = seen.windows
    near = (np.abs(w.turn) < _MOST_TURN) & (np.abs(w.rotation) < _MOST_ROTATION)
    near &= np.hypot(w.forward, w.sideways) > _LEAST
    if int(near.sum()) < _ENOUGH:
        return None
    way = (w.distance * np.exp(1j * w.course_ahead(seen.sensor_yaw)))[near]
    moved = np.column_stack((way.real, way.imag))
    given = np.column_stack((w.forward, w.sideways, w.rotation))[near]
    return _Ways(
        moved, w.turn[near], given, np.column_stack([robust_fit(given, each)[0] for each in moved.T])
    )


def _sizes(values: Floats) -> tuple[float, float]:
    """Return the root mean squares of two columns."""
    first, second = np.sqrt(np.mean(values**2, axis=0)).tolist()
    return first, second
