# SPDX-License-Identifier: Apache-2.0
"""Maps of what is free: from arrays, or from the YAML and PGM files of ROS's map_server."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.errors import PlanningError
from slipwise.models.yaml_file import read_yaml
from slipwise.planning.pgm import MOST_PIXELS, read_levels

Floats = NDArray[np.float64]

FINEST, COARSEST = 1e-3, 10.0  # m, of a cell; outside of these the unit is wrong
FARTHEST = 1e8  # m, of a map's origin
FAR = 1e3  # m, farther than any clearance: beyond the map all is occupied
CELL_REACH = math.sqrt(0.5)  # cells, from a cell's centre to its corner


@dataclass(frozen=True, eq=False)
class GridMap:
    """Square cells; what is not known to be free counts as occupied, and so does all beyond the map.

    Raises:
        PlanningError: the cells are no grid, or their size makes no sense.
    """

    occupied: NDArray[np.bool_]  # [rows, columns], rows in order of growing y
    resolution: float  # side of a cell [m]
    origin: tuple[float, float] = (0.0, 0.0)  # x, y of the corner of cell (0, 0) [m]
    clearance: NDArray[np.float32] = field(init=False, repr=False)  # [rows, columns] m to what is occupied

    def __post_init__(self) -> None:
        cells = np.asarray(self.occupied)
        if cells.ndim != 2 or cells.size == 0:
            raise PlanningError(f"the map has shape {cells.shape}", advice="give [rows, columns] of cells")
        if cells.dtype != np.bool_:
            raise PlanningError(
                f"the map's cells are {cells.dtype}", advice="give booleans, such as costs > 50"
            )
        if not (math.isfinite(self.resolution) and FINEST <= self.resolution <= COARSEST):
            raise PlanningError(
                f"a map's resolution of {self.resolution} m makes no sense",
                where="resolution",
                advice=f"give metres per cell, {FINEST:g} to {COARSEST:g}",
            )
        if not all(abs(value) <= FARTHEST for value in self.origin):
            advice = f"give metres, {FARTHEST:g} at most"
            raise PlanningError("the map's origin is not a place on earth", where="origin", advice=advice)
        beyond = np.pad(cells.astype(np.uint8), 1, constant_values=1)  # what lies beyond the map is not free
        field_ = _core.distance_field(beyond, self.resolution, FAR)[1:-1, 1:-1]
        reach = 2.0 * CELL_REACH * self.resolution  # half a cell each, of the robot's place and the obstacle
        object.__setattr__(self, "clearance", np.maximum(field_ - np.float32(reach), np.float32(0.0)))

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m]."""
        rows, columns = self.occupied.shape
        return columns * self.resolution, rows * self.resolution

    def clearance_at(self, points: ArrayLike) -> Floats:
        """Return at least how far it is from points [N, 2] to what is occupied [m]; 0 beyond the map."""
        xy = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        place = (xy - self.origin) / self.resolution
        inside = ((place >= 0.0) & (place < self.occupied.shape[::-1])).all(axis=1)  # false for NaN
        column, row = place[inside].astype(np.int64).T
        found = np.zeros(len(xy))
        found[inside] = self.clearance[row, column]
        return found


def load_map(path: str | Path, *, most_cells: int = MOST_PIXELS) -> GridMap:
    """Read a map of ROS's map_server: a YAML file that names a PGM image of at most `most_cells` pixels.

    Raises:
        PlanningError: a file is missing or wrong, or the map is rotated.
        SettingsError: this is no path.
    """
    check_arguments(load_map, locals())
    source = Path(path)
    content = read_yaml(source, error=PlanningError)
    levels, white = read_levels(_image(source, content), most_pixels=most_cells)
    grey = np.arange(white + 1) / white
    fraction = grey if _number(content, "negate", source, default=0.0) else 1.0 - grey
    free = (fraction < _number(content, "free_thresh", source, default=0.196))[levels]
    origin = content.get("origin")
    if not isinstance(origin, list) or len(origin) < 2 or not all(_is_number(value) for value in origin):
        raise _fault(source, "origin", "is not a list of x, y, yaw", "such as [-10.0, -10.0, 0.0]")
    if len(origin) > 2 and origin[2] != 0.0:
        raise _fault(source, "origin", "is rotated", "save the map with a yaw of 0")
    resolution = _number(content, "resolution", source)
    try:
        return GridMap(np.flipud(~free).copy(), resolution, (float(origin[0]), float(origin[1])))
    except PlanningError as problem:
        raise PlanningError(
            problem.what, where=f"{source}, {problem.where}", advice=problem.advice
        ) from problem


def image_of(path: str | Path) -> Path:
    """Return the image that a map's YAML file names.

    Raises:
        PlanningError: the file is missing or wrong, or names none.
    """
    return _image(Path(path), read_yaml(Path(path), error=PlanningError))


def _image(source: Path, content: dict[str, Any]) -> Path:
    image = content.get("image")
    if not isinstance(image, str):
        raise _fault(source, "image", "names no image", "give the name of a PGM file")
    return source.parent / image


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _number(content: dict[str, Any], key: str, source: Path, *, default: float | None = None) -> float:
    value = content.get(key, default)
    if not _is_number(value):
        raise _fault(source, key, "is not a number", "see the files that map_saver writes")
    return float(value)  # type: ignore[arg-type]


def _fault(source: Path, key: str, what: str, advice: str) -> PlanningError:
    return PlanningError(f"the map's `{key}` {what}", where=str(source), advice=advice)
