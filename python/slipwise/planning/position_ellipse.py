# SPDX-License-Identifier: Apache-2.0
"""Whether the ellipses that predicted positions lie in stay within what is free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.planning.grid_map import GridMap
from slipwise.student import ellipse_squared

Floats = NDArray[np.float64]

SHARE = 0.95  # of the positions, within the ellipse
POINTS = 48  # of an outline
STEP = 1.0  # cells, between the points along its half-axes


@dataclass(frozen=True)
class Crossing:
    """The first ellipse that leaves what is free."""

    at: int  # place among the predictions
    half_axis: float  # m, the longer one


def first_crossing(
    grid: GridMap, positions: Floats, covariance: Floats, dof: Floats, yaw: float
) -> Crossing | None:
    """Return the first ellipse with a place that is not free, None where all are free.

    Args:
        grid: what is free.
        positions: [K, 2] x, y in the map's frame [m].
        covariance: [K, 2, 2] of x, y in the frame of the start [m^2].
        dof: [K] degrees of freedom of the Student t with these covariances.
        yaw: of the start in the map's frame [rad].
    """
    to_map = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    values, vectors = np.linalg.eigh(to_map @ covariance @ to_map.T)
    radius = np.sqrt([ellipse_squared(SHARE, float(freedom)) for freedom in dof])
    axes = radius[:, None] * np.sqrt(np.maximum(values, 0.0))
    for k in range(len(positions)):
        shape = vectors[k] * axes[k]
        if not _is_free(grid, positions[k], shape, float(axes[k, 1])):
            return Crossing(k, float(axes[k, 1]))
    return None


def _is_free(grid: GridMap, centre: Floats, shape: Floats, longer: float) -> bool:
    if not np.isfinite(longer) or 2.0 * longer > max(grid.size):
        return False
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    rings = np.linspace(0.0, 1.0, 2 + int(longer / (STEP * grid.resolution)))
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    points = (rings[:, None, None] * circle).reshape(-1, 2)
    return bool(grid.clearance_at(centre + points @ shape.T).min() > 0.0)
