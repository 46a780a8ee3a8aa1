# SPDX-License-Identifier: Apache-2.0
"""Ellipses along a predicted path that the position lies in."""

from __future__ import annotations

import math

import numpy as np

from slipwise.ellipse import outline_of
from slipwise.live.outputs import Floats, Path

_RADIUS = math.sqrt(-2.0 * math.log(0.05))  # standard deviations around 95 % of a normal in a plane
_MOST = 6


def path_ellipses(path: Path) -> list[Floats]:
    """Return closed outlines [points, 2] around 95 %, in m, at a few poses, the last among them."""
    count = len(path.poses)
    if count == 0:
        return []
    chosen = np.unique(np.linspace((count - 1) / _MOST, count - 1, _MOST).round().astype(int)).tolist()
    outlines = (outline_of(path.poses[i, :2], path.covariance[i, :2, :2], _RADIUS) for i in chosen)
    return [outline[::2] for outline in outlines if outline is not None]
