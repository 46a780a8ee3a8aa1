# SPDX-License-Identifier: Apache-2.0
"""Where rollouts start: poses, what the drive does, and the commands that are still in its delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.ground import Grade, rise_of
from slipwise.models.axes import Axes
from slipwise.terrain_ahead import TerrainAhead

Floats = NDArray[np.float64]

GroundOfRollouts = tuple[float, float, float, float]  # gx, gy [m/s^2], rise along x and along y [m/m]


@dataclass(frozen=True, eq=False)
class StartRows:
    """A start for each of S rollouts, or one for all."""

    pose: Floats  # [S, 3]
    drive: Floats  # [S, axes of the drive]
    past: Floats  # [S, P, axes of the commands]


@dataclass(frozen=True, eq=False)
class Start:
    """One start for all rollouts, or one each."""

    pose: ArrayLike = (0.0, 0.0, 0.0)  # [3] or [N, 3]: x, y [m], yaw [rad]; results are in its frame
    # [2] or [N, 2]: v [m/s], omega [rad/s] now; they matter behind lag and ramps. At rest where it is None.
    # Of a robot that drives sideways v, vy, omega.
    drive: ArrayLike | None = None
    # [P, axes] or [N, P, axes]: commands sent before, one period apart, the oldest first
    past: ArrayLike | None = None
    gravity: tuple[float, float] = (0.0, 0.0)  # m/s^2 along the robot's x and y axes, positive downhill
    grade: Grade | None = None  # of the ground in the frame of `pose`, in place of `gravity`
    terrain_ahead: TerrainAhead | None = None  # surfaces at distances along each rollout's path

    @property
    def ground(self) -> GroundOfRollouts:
        """Gravity, and how much the ground rises per metre along the axes of the frame of `pose`."""
        return (*self.gravity, *rise_of(self.grade))

    def in_core(self, rollouts: int, axes: Axes) -> _core.StartList:
        """Check the start against the number of rollouts and hand it to the core.

        Raises:
            SettingsError: a shape does not fit, or a number is not finite.
        """
        rows = self.rows(rollouts, axes)
        starts = np.hstack((rows.pose, axes.twists(rows.drive)))
        return _core.StartList(starts, np.ascontiguousarray(axes.twists(rows.past)))

    def rows(self, rollouts: int, axes: Axes, *, sent: Axes | None = None) -> StartRows:
        """Check the start against the number of rollouts and return it as rows.

        Args:
            rollouts: how many there are.
            axes: of the drive.
            sent: of the commands; by default those of the drive.

        Raises:
            SettingsError: a shape does not fit, or a number is not finite.
        """
        pose = _rows("pose", self.pose, 3)
        drive = _rows("drive", np.zeros(len(axes)) if self.drive is None else self.drive, len(axes))
        starts = max(len(pose), len(drive))
        commands = axes if sent is None else sent
        past = np.zeros((1, 0, len(commands))) if self.past is None else _past(self.past, commands)
        starts = max(starts, len(past))
        if starts not in (1, rollouts):
            raise SettingsError(
                f"there are {starts} starts for {rollouts} rollouts", advice="give one start, or one each"
            )
        return StartRows(
            _repeated("pose", pose, starts),
            _repeated("drive", drive, starts),
            _repeated("past", past, starts),
        )


def _rows(name: str, values: ArrayLike, width: int) -> Floats:
    rows = np.atleast_2d(_finite(name, values))
    if rows.ndim != 2 or rows.shape[1] != width or len(rows) == 0:
        raise SettingsError(
            f"the start's {name} has shape {np.shape(values)}",
            advice=f"give {width} numbers, or rows of {width}",
        )
    return rows


def _past(values: ArrayLike, axes: Axes) -> Floats:
    past = _finite("past", values)
    if past.ndim == 2:
        past = past[None]
    if past.ndim != 3:
        raise SettingsError(
            f"the start's past has shape {np.shape(values)}",
            advice=f"give commands [P, {len(axes)}], or [N, P, {len(axes)}]",
        )
    axes.check("the start's past is rows", past.shape[2])
    return past


def _finite(name: str, values: ArrayLike) -> Floats:
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise SettingsError(f"the start's {name} is not an array of numbers") from problem
    if not np.isfinite(numbers).all():
        raise SettingsError(f"the start's {name} is not finite", advice="leave out what is not known")
    return numbers


def _repeated(name: str, rows: Floats, starts: int) -> Floats:
    if len(rows) == starts:
        return rows
    if len(rows) != 1:
        raise SettingsError(
            f"the start has {len(rows)} rows of {name} and {starts} of others", advice="give one, or one each"
        )
    return np.repeat(rows, starts, axis=0)
