# SPDX-License-Identifier: Apache-2.0
"""How alarms of a change are scored: windows until it is found, and alarms where there was none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Alarms = list[int]  # windows

LONGEST = 40  # windows; what is not found by then counts as this
WARM_UP = 20  # windows before the first test of slipwise; false alarms are counted after them


@dataclass(frozen=True, eq=False)
class Course:
    """What a learner that takes no notice of changes says of each window before it learns it."""

    odds: Floats  # [W] log odds of a change by slipwise's test
    signed: Floats  # [W, 2] whitened innovation along the way and the turn: a change of slip keeps its sign
    nis: Floats  # [W]
    changes: tuple[int, ...]  # windows from which the ground is another


@dataclass(frozen=True)
class Point:
    """One finder at one setting over some courses."""

    finder: str
    setting: str
    false_alarms: float  # per 1000 windows
    delay: float  # windows, mean; what was not found counts as LONGEST
    found: float  # fraction of changes found


def delays(course: Course, alarms: Alarms, *, offline: bool) -> list[int]:
    """Return after how many windows each change was found."""
    result = []
    for place, change in enumerate(course.changes):
        end = course.changes[place + 1] if place + 1 < len(course.changes) else len(course.odds)
        if offline:
            near = [abs(a - change) for a in alarms if a > change - LONGEST]
        else:
            near = [a - change + 1 for a in alarms if change <= a < end]
        result.append(min([*near, LONGEST]))
    return result


def false_alarms(course: Course, alarms: Alarms, *, offline: bool) -> tuple[int, int]:
    """Return alarms before the first change, and the windows in which there could be one.

    After it a learner that takes no notice is wrong for long, so that no alarm there is a false one.
    """
    free = np.zeros(len(course.odds), np.bool_)
    first = course.changes[0] if course.changes else len(free)
    free[WARM_UP : max(first - LONGEST, 0) if offline else first] = True
    return int(sum(free[a] for a in alarms)), int(free.sum())


def at_budget(points: list[Point], budget: float) -> Point | None:
    """Return the soonest setting with at most `budget` false alarms per 1000 windows."""
    return min((p for p in points if p.false_alarms <= budget), key=lambda p: p.delay, default=None)
