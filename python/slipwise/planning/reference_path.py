# SPDX-License-Identifier: Apache-2.0
"""A path to follow at a speed: where the robot is along it, and where it should be next."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.errors import SettingsError

Floats = NDArray[np.float64]

SEARCH = 3.0  # m ahead, and a third of it behind, within which the robot is looked for on the path


@dataclass(eq=False)
class ReferencePath:
    """Points that are joined by straight lines; it remembers how far along the robot has come.

    Raises:
        SettingsError: fewer than two different points, or points or a speed that make no sense.
    """

    points: Floats  # [N, 2] x, y [m]
    speed: float  # m/s
    progress: float = 0.0  # m along the path
    _along: Floats = field(init=False, repr=False)
    _heading: Floats = field(init=False, repr=False)
    _steps: Floats = field(init=False, repr=False)  # [N - 1, 2] m
    _squares: Floats = field(init=False, repr=False)  # [N - 1] m^2, of these
    _lengths: Floats = field(init=False, repr=False)  # [N - 1] m

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise SettingsError(
                "a path is rows of finite x, y", where="points", advice="give [N, 2] in metres"
            )
        steps = np.hypot(*np.diff(points, axis=0).T)
        points = points[np.append(steps > 0.0, True)]
        if len(points) < 2:
            raise SettingsError(
                "a path needs two different points", where="points", advice="give more points"
            )
        if not (np.isfinite(self.speed) and self.speed > 0.0):
            raise SettingsError(f"the speed is {self.speed}", where="speed", advice="give metres per second")
        self.points = points
        self._steps = steps = np.diff(points, axis=0)
        self._squares = (steps**2).sum(axis=1)
        self._along = np.concatenate(([0.0], np.cumsum(np.hypot(*steps.T))))
        self._lengths = np.diff(self._along)
        self._heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self._along[-1])

    def nearest(self, point: ArrayLike) -> tuple[float, float]:
        """Return the place along the path nearest to a point, and how far left of it that is [m].

        It is looked for near the last `progress`, so that a path may cross itself.
        """
        step, since = self._steps, np.asarray(point) - self.points[:-1]
        fraction = np.clip((since * step).sum(axis=1) / self._squares, 0.0, 1.0)
        offset = np.asarray(point) - (self.points[:-1] + fraction[:, None] * step)
        place = self._along[:-1] + fraction * self._lengths
        far = (place < self.progress - SEARCH / 3.0) | (place > self.progress + SEARCH)
        squared = (offset**2).sum(axis=1) + np.where(far, 1e12, 0.0)
        best = int(np.argmin(squared))
        left = step[best, 0] * offset[best, 1] - step[best, 1] * offset[best, 0]
        return float(place[best]), float(np.copysign(np.hypot(*offset[best]), left))

    def ahead(self, pose: tuple[float, float, float], periods: int, period: float) -> Floats:
        """Return where the robot should be at the ends of the next periods, [periods, 3] x, y, yaw.

        Yaws are unwrapped near the robot's. The robot's place along the path is remembered.
        """
        self.progress = self.nearest(pose[:2])[0]
        wanted = np.minimum(self.progress + self.speed * period * np.arange(1, periods + 1), self.length)
        x, y = (np.interp(wanted, self._along, self.points[:, i]) for i in (0, 1))
        middles = 0.5 * (self._along[:-1] + self._along[1:])
        yaw = np.interp(wanted, middles, self._heading)
        turns = np.round((pose[2] - yaw[0]) / (2.0 * np.pi))
        return np.column_stack((x, y, yaw + 2.0 * np.pi * turns))
