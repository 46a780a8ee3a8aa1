# SPDX-License-Identifier: Apache-2.0
"""Ground that is not level, as predictions and plans take it: a constant grade, or a map of elevations."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError

Floats = NDArray[np.float64]
Pose = tuple[float, float, float]  # x, y [m], yaw [rad]

STEEPEST = math.radians(60.0)  # rad; no wheel holds on what is steeper


@runtime_checkable
class Ground(Protocol):
    """What a robot may stand on."""

    def under(self, pose: Pose) -> _core.Ground:
        """Return it as a path sees it that begins at `pose`.

        Raises:
            SettingsError: there is no ground there.
        """
        ...


@dataclass(frozen=True)
class Grade:
    """A plane that falls in one direction.

    Raises:
        SettingsError: the slope is negative or beyond 60 degrees, or a number is not finite.
    """

    slope: float  # rad, of the steepest line against the horizontal
    downhill: float = 0.0  # rad, the direction in which water runs, in the frame of the poses

    def __post_init__(self) -> None:
        if not (math.isfinite(self.downhill) and 0.0 <= self.slope <= STEEPEST):
            raise SettingsError(
                f"a slope of {self.slope:g} rad towards {self.downhill:g} rad is not a grade",
                advice=f"give a slope from 0 to {STEEPEST:.2f} rad, and the direction in which it falls",
            )

    def rise(self, yaw: float) -> tuple[float, float]:
        """Return how much the ground rises per metre, seen from above, along `yaw` and to the left of it."""
        steepness, angle = math.tan(self.slope), self.downhill - yaw
        return -steepness * math.cos(angle), -steepness * math.sin(angle)

    def under(self, pose: Pose) -> _core.Ground:
        """Return it as a path sees it that begins at `pose`, of which only the yaw matters."""
        return _core.Ground.grade(*self.rise(pose[2]))


def rise_of(grade: Grade | None) -> tuple[float, float]:
    """Return how much a plane rises per metre along the axes of the frame of the poses; level without one."""
    return (0.0, 0.0) if grade is None else grade.rise(0.0)


@dataclass(frozen=True, eq=False)
class ElevationMap:
    """Elevations on a grid, such as a layer of a grid_map or a digital terrain model.

    Raises:
        SettingsError: there are less than two rows or columns, a node is not finite, or the cell is not
            positive.
    """

    elevation: Floats  # [H, W] m, a row for each y, a column for each x
    origin: tuple[float, float]  # m, (x, y) of elevation[0, 0]
    cell: float  # m, between neighbours
    _core_map: _core.ElevationMap = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            nodes = np.asarray(self.elevation, dtype=np.float64)
            made = _core.ElevationMap(nodes, np.asarray(self.origin, dtype=np.float64), float(self.cell))
        except (TypeError, ValueError) as problem:
            said = str(problem) if isinstance(problem, ValueError) else "these are no numbers"
            raise SettingsError(
                said.splitlines()[0], advice="give elevations [H, W] in m, an origin (x, y) and a cell"
            ) from problem
        object.__setattr__(self, "_core_map", made)

    def under(self, pose: Pose) -> _core.Ground:
        """Return it as a path sees it that begins at `pose`.

        Raises:
            SettingsError: the pose does not lie on the map.
        """
        if not self._core_map.holds(pose[0], pose[1]):
            raise _beside("the path begins", pose)
        return _core.Ground.mapped(self._core_map, _core.Pose2(*pose))

    def holds(self, poses: Floats) -> bool:
        """Whether all poses [N, 3] lie on the map."""
        return all(self._core_map.holds(x, y) for x, y, _ in poses.tolist())

    def check(self, poses: Floats) -> None:
        """Refuse poses [N, 3] that lie beside the map.

        Raises:
            SettingsError: one does.
        """
        for x, y, _ in poses.tolist():
            if not self._core_map.holds(x, y):
                raise _beside("the path leads", (x, y, 0.0))


def _beside(what: str, pose: Pose) -> SettingsError:
    return SettingsError(
        f"{what} beside the map of elevations, at ({pose[0]:.2f}, {pose[1]:.2f}) m",
        advice="give a map that holds the whole path, and the pose of its start",
    )
