# SPDX-License-Identifier: Apache-2.0
"""How probable each surface was along a drive, and where a change of terrain was found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SurfaceCourse:
    """One row per learned window, in the order learned; the name "" is of a surface that had none yet."""

    run: Ints  # [W] index of the run in the log
    t: Floats  # [W] s, the end of the window: everything in this row was known then
    names: tuple[str, ...]  # [S] surfaces
    probability: Floats  # [W, S] of each to be the one under the robot
    alarm: NDArray[np.bool_]  # [W] whether a change of terrain was found

    def __repr__(self) -> str:
        return f"<SurfaceCourse: {len(self.t)} windows on {len(self.names)} surfaces>"


def course_of(
    events: Sequence[_core.LearnerEvent], run: Sequence[int], alarm: Sequence[bool]
) -> SurfaceCourse | None:
    """Return the course that the events of learned windows tell; None where no surface is remembered.

    Args:
        events: of learned windows, in order.
        run: index in the log of each event's run.
        alarm: whether each window raised an alarm.
    """
    rows = [{each.name: each.probability for each in event.surfaces} for event in events]
    if not any(rows):
        return None
    names = tuple(dict.fromkeys(name for row in rows for name in row))
    return SurfaceCourse(
        run=np.array(run, dtype=np.int64),
        t=np.array([event.t for event in events]),
        names=names,
        probability=np.array([[row.get(name, 0.0) for name in names] for row in rows]),
        alarm=np.array(alarm, dtype=np.bool_),
    )
