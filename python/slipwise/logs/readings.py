# SPDX-License-Identifier: Apache-2.0
"""Sensors that measure one number, such as a gyro: the core's table of them, and what they measured."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.log import Floats, Run

READINGS = tuple(_core.reading_kinds())  # in the order in which they count at one stamp
_NONE = np.empty((0, 2))


def number_rows(run: Run, column: str) -> Floats:
    """Return rows of (t, number), [N, 2], that a column of a run holds; none where it is text."""
    if column not in run.extra:
        return _NONE
    try:
        t, number = (np.asarray(run.extra[name], dtype=np.float64) for name in ("t", column))
    except ValueError:  # text
        return _NONE
    rows = np.column_stack((t, number))
    rows = rows[np.isfinite(rows).all(axis=1)]
    return rows[np.unique(rows[:, 0], return_index=True)[1]]
