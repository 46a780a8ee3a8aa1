# SPDX-License-Identifier: Apache-2.0
"""A map of cost, or of clearance, that rollouts sample along their way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from slipwise import _core
from slipwise.errors import SettingsError


@dataclass(frozen=True, eq=False)
class Costmap:
    """Square cells; `cells[row, column]` lies at growing y and x."""

    cells: ArrayLike  # [rows, columns]
    resolution: float  # side of a cell [m]
    origin: tuple[float, float] = (0.0, 0.0)  # corner of the first cell, in the frame of the start's pose [m]
    outside: float = 0.0  # value beyond the map

    @cached_property
    def in_core(self) -> _core.CostmapView:
        """The map as the core reads it; made once.

        Raises:
            SettingsError: there are no cells, or the resolution or origin is no sensible number.
        """
        cells = np.ascontiguousarray(self.cells, dtype=np.float32)
        if cells.ndim != 2 or cells.size == 0:
            raise SettingsError(f"a costmap has shape {cells.shape}", advice="give rows and columns of cells")
        if not (np.isfinite(self.resolution) and self.resolution > 0.0):
            raise SettingsError(
                f"a costmap's resolution is {self.resolution}", advice="give metres per cell, such as 0.05"
            )
        if not np.isfinite(self.origin).all():
            raise SettingsError("a costmap's origin is not finite", advice="give x and y in metres")
        return _core.CostmapView(cells, self.resolution, *self.origin, self.outside)
