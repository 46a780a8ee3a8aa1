# SPDX-License-Identifier: Apache-2.0
"""Finds one wheel that counts otherwise than the other: the robot turns where its wheels go straight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.robust_fit import robust_fit

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen
    from slipwise.logs.log import Bools, Floats
    from slipwise.logs.motion_windows import MotionWindows

_LEAST, _LEAST_TURN = 0.03, 0.15  # m or rad by the wheels, in a window that is looked at
_MOST_TURN = 2.5  # [rad]
_FEWEST = 10  # windows on either side of a change
_PULLS = 0.15  # [rad/m] while wheels go straight; real robots turn by 0.05 at most
_SIGMAS = 12.0  # by which it is known; of real logs 7 at most where it changes by as much
_LEFT_OVER = 0.75  # of the squares of one line, two leave at most; real logs keep 0.83 where it changes so
_ALIKE = 0.995  # correlation of ways and turns from which on neither is known


class UnevenWheels(Check):
    """One wheel that counts otherwise than the other, always or from some time on."""

    kind, family, spoils = "uneven-wheels", "encoders", False
    means = "one wheel counts otherwise than the other, or a steering angle is off"
    shows = "turns by 0.15 rad/m where the wheels go straight; it spoils where that changes"
    cure = "the ticks of a turn of that wheel, its encoder, the zero of the steering"
    explained_by = ("unlikely-speed", "does-not-move", "parent-twist", "lost-heading", "constant-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look whether turns for each metre change at some time, then whether they are many throughout."""
        w = seen.windows_of("wheel")
        used = _used(w)
        if seen.positions or int(used.sum()) < 2 * _FEWEST:
            return None
        way, wheels, poses = w.forward[used], w.rotation[used], w.turn[used]
        change, left_over = _best_change(way, wheels, poses)
        parts = [_line(*(each[part] for each in (way, wheels, poses))) for part in _sides(change)]
        before, after = parts
        differ = after.pull - before.pull
        if (
            left_over < _LEFT_OVER
            and abs(differ) > max(_PULLS, _SIGMAS * float(np.hypot(before.sigma, after.sigma)))
            and max(before.alike, after.alike) < _ALIKE
        ):
            return self.found(
                f"where the wheels go straight, the robot turns by {before.pull:.2f} rad for each metre "
                f"until {w.since[used][change]:.0f} s, and by {after.pull:.2f} afterwards: one wheel counts "
                "otherwise than it did",
                "Look at the encoders and their cables; --start and --end take what is sound.",
                evidence=differ,
                spoils=seen.input_name == "wheel",
            )
        whole = _line(way, wheels, poses)
        if abs(whole.pull) < max(_PULLS, _SIGMAS * whole.sigma) or whole.alike > _ALIKE:
            return None
        more = "left" if whole.pull > 0.0 else "right"
        return self.found(
            f"where the wheels go straight, the robot turns by {whole.pull:.2f} rad for each metre: the "
            f"{more} wheel counts more than the other, or is said to be larger than it is",
            "Measure both wheels and the ticks of a turn of each.",
            evidence=whole.pull,
        )


@dataclass(frozen=True)
class _Line:
    """Turns of poses as a sum of what the wheels drive and turn."""

    pull: float  # [rad/m]
    sigma: float  # of it
    alike: float  # correlation of what wheels drive and turn


def _used(w: MotionWindows) -> Bools:
    """Say which windows tell how a robot turns that does not drive sideways."""
    moves = (np.abs(w.forward) > _LEAST) | (np.abs(w.rotation) > _LEAST_TURN)
    turns = np.maximum(np.abs(w.turn), np.abs(w.rotation)) < _MOST_TURN
    return np.asarray(moves & turns & (np.abs(w.sideways) < 0.2 * np.abs(w.forward) + 0.01))


def _sides(change: int) -> tuple[slice, slice]:
    return slice(None, change), slice(change, None)


def _best_change(way: Floats, wheels: Floats, poses: Floats) -> tuple[int, float]:
    """Return the window before which a line of its own fits best, and which part of the squares is left."""
    products = (way * way, way * wheels, wheels * wheels, way * poses, wheels * poses, poses * poses)
    upto = np.cumsum(np.stack(products), axis=1)
    total, first = upto[:, -1], upto[:, _FEWEST - 1 : -_FEWEST]
    left = _squares_left(first) + _squares_left(total[:, None] - first)
    best = int(np.argmin(left))
    return best + _FEWEST, float(left[best] / _squares_left(total[:, None])[0])


def _squares_left(sums: Floats) -> Floats:
    """Return the squares [K] that a line leaves, of sums [6, K] of products."""
    aa, ab, bb, ay, by, yy = sums
    least = 1e-9
    determinant = np.maximum(aa * bb - ab * ab, least)
    explained = ay * (bb * ay - ab * by) + by * (aa * by - ab * ay)
    return np.asarray(np.maximum(yy - explained / determinant, least))


def _line(way: Floats, wheels: Floats, poses: Floats) -> _Line:
    """Fit a line that few windows which go astray do not bend."""
    inputs = np.stack((way, wheels), axis=1)
    gains, weight, usual = robust_fit(inputs, poses)
    normal = (inputs * weight[:, None]).T @ inputs
    both = float(normal[0, 0] * normal[1, 1])
    alike = abs(float(normal[0, 1])) / np.sqrt(both) if both > 0.0 else 1.0
    known = float(normal[0, 0]) * (1.0 - alike**2)
    return _Line(float(gains[0]), usual / np.sqrt(known) if known > 0.0 else np.inf, alike)
