# SPDX-License-Identifier: Apache-2.0
"""Maps are read as map_server writes them, know their clearance, and are refused where they make no sense."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import PlanningError
from slipwise.planning import GridMap, load_map
from slipwise.planning.pgm import write_pgm

KEYS = {
    "image": "map.pgm",
    "resolution": "0.5",
    "origin": "[-1.0, -2.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}


def written(folder: Path, **changed: str) -> Path:
    """Write a map of 4 x 6 cells that is occupied in its lower left corner and unknown in its upper right."""
    grey = np.full((4, 6), 254 / 255)
    grey[3, 0], grey[0, 5] = 0.0, 205 / 255
    write_pgm(folder / "map.pgm", grey)
    lines = [f"{key}: {value}" for key, value in (KEYS | changed).items() if value]
    path = folder / "map.yaml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_a_map_is_read_with_its_lower_row_first(tmp_path: Path) -> None:
    grid = load_map(written(tmp_path))
    expected = np.zeros((4, 6), dtype=bool)
    expected[0, 0] = expected[3, 5] = True
    assert (grid.occupied == expected).all()
    assert (grid.resolution, grid.origin, grid.size) == (0.5, (-1.0, -2.0), (3.0, 2.0))


def test_clearance_never_overstates_the_room_and_ends_at_the_map() -> None:
    occupied = np.zeros((50, 60), dtype=bool)
    occupied[20:23, 30] = True
    grid = GridMap(occupied, 0.2, (1.0, 2.0))
    rng = np.random.Generator(np.random.PCG64(2))
    points = np.array([1.0, 2.0]) + rng.random((400, 2)) * grid.size
    low, high = np.array([7.0, 6.0]), np.array([7.2, 6.6])  # the obstacle's corners
    to_obstacle = np.hypot(*np.maximum(np.maximum(low - points, points - high), 0.0).T)
    to_edge = np.minimum(points - grid.origin, np.array(grid.origin) + grid.size - points).min(axis=1)
    true = np.minimum(to_obstacle, to_edge)
    stated = grid.clearance_at(points)
    assert (stated <= true + 1e-9).all()
    assert (stated >= true - 0.6).all()
    assert grid.clearance_at([[0.9, 3.0], [100.0, 3.0]]).tolist() == [0.0, 0.0]


def test_beyond_the_map_nothing_is_free() -> None:
    grid = GridMap(np.zeros((100, 200), dtype=bool), 0.1, (-10.0, -5.0))
    middle, edge = grid.clearance_at([[0.0, 0.0], [-9.75, 0.0]])
    assert 4.7 < middle <= 5.0
    assert edge <= 0.25


def test_a_map_that_makes_no_sense_is_refused(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for changed, message in [
        ({"resolution": "-0.1"}, "resolution of -0.1 m makes no sense"),
        ({"resolution": "500.0"}, "resolution of 500.0 m makes no sense"),
        ({"resolution": ".nan"}, "resolution of nan m makes no sense"),
        ({"resolution": "fine"}, "`resolution` is not a number"),
        ({"resolution": ""}, "`resolution` is not a number"),
        ({"image": ""}, "`image` names no image"),
        ({"image": "no.pgm"}, "cannot read the map's image"),
        ({"image": "map.yaml"}, "is no PGM image"),
        ({"image": '"a\\0.pgm"'}, "not the name of a file"),
        ({"image": "/dev/zero"}, "not a regular file"),
        ({"origin": "[1.0e+300, 0.0, 0.0]"}, "origin is not a place on earth"),
        ({"origin": "[.nan, 0.0, 0.0]"}, "origin is not a place on earth"),
        ({"origin": "[0.0]"}, "`origin` is not a list"),
        ({"origin": "[0.0, 0.0, 0.5]"}, "`origin` is rotated"),
    ]:
        with subtests.test(changed=changed, message=message):
            with pytest.raises(PlanningError, match=message) as caught:
                load_map(written(tmp_path, **changed))
            assert str(tmp_path) in caught.value.where or caught.value.where == "/dev/zero"
            assert caught.value.advice


def test_how_many_cells_are_read_is_a_setting(tmp_path: Path) -> None:
    assert load_map(written(tmp_path), most_cells=24).occupied.size == 24
    with pytest.raises(PlanningError, match=r"has 6 x 4 pixels, more than 23 .*--most-cells"):
        load_map(written(tmp_path), most_cells=23)


def test_points_that_are_nowhere_have_no_clearance() -> None:
    grid = GridMap(np.zeros((5, 5), dtype=bool), 0.5)
    assert grid.clearance_at([[1e300, 0.0], [np.nan, 1.0], [-np.inf, 1.0]]).tolist() == [0.0, 0.0, 0.0]


def test_cells_that_are_no_grid_are_refused() -> None:
    with pytest.raises(PlanningError, match="shape"):
        GridMap(np.zeros((0, 4), dtype=bool), 0.1)
    with pytest.raises(PlanningError, match="give booleans"):
        GridMap(np.zeros((3, 4)), 0.1)  # type: ignore[arg-type]
