# SPDX-License-Identifier: Apache-2.0
"""The surfaces of a course under the names that they have in the end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.learned_sequence import SurfaceChange
from slipwise.reporting.ground_strip import UNNAMED

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def named_surfaces(
    names: Sequence[str],
    probability: Floats,
    changes: Sequence[tuple[int, SurfaceChange]],
    *,
    last: str,
) -> tuple[tuple[str, ...], Floats]:
    """Give surfaces that had no name while they were driven the one they got, and merged ones their last.

    Args:
        names: [S], "" for what had no name yet.
        probability: [W, S].
        changes: what happened, each after how many windows; in order.
        last: name of the surface under the robot in the end, "" where that is open.

    Returns:
        Names in the order in which they were driven, and the probability of each, [W, names].
    """
    renamed = {change.other: change.name for _, change in changes if change.what == "merged"}
    places = np.zeros((len(probability), len(names)), np.int64)
    found: dict[str, int] = {}
    for row in range(len(probability)):
        for column, name in enumerate(names):
            if not probability[row, column]:
                continue
            shown = _last_name(name or _later_name(row, changes, last), renamed)
            places[row, column] = found.setdefault(shown, len(found))
    joined = np.zeros((len(probability), max(len(found), 1)))
    for column in range(len(names)):
        joined[np.arange(len(joined)), places[:, column]] += probability[:, column]
    return tuple(found) or (UNNAMED,), joined


def _later_name(row: int, changes: Sequence[tuple[int, SurfaceChange]], last: str) -> str:
    """A surface is named when it is left: the next change of another kind says that it never was."""
    for after, change in changes:
        if after <= row or change.what not in ("new", "recalled"):
            continue
        if change.what == "new" and change.name:
            return change.name
        spoke = after - change.segments <= row  # the window is one of those that opened the new surface
        if not (change.what == "new" and spoke):
            return UNNAMED
    return last or UNNAMED


def _last_name(name: str, renamed: dict[str, str]) -> str:
    while name in renamed:
        name = renamed[name]
    return name
