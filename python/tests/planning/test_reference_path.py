# SPDX-License-Identifier: Apache-2.0
"""A reference knows where the robot is along it and where it should be next."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.planning import ReferencePath

CORNER = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 6.0]])  # a doubled point does no harm


def test_the_nearest_place_has_its_side() -> None:
    reference = ReferencePath(CORNER, 1.0)
    assert reference.length == 10.0
    assert reference.nearest((1.5, 0.3)) == pytest.approx((1.5, 0.3))
    assert reference.nearest((1.5, -0.3)) == pytest.approx((1.5, -0.3))
    reference.progress = 5.0
    assert reference.nearest((3.8, 2.0)) == pytest.approx((6.0, 0.2))


def test_a_path_that_crosses_itself_is_followed_in_order() -> None:
    loop = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [5.0, 10.0], [5.0, -5.0]])
    reference = ReferencePath(loop, 1.0)
    reference.progress = 4.0
    assert reference.nearest((5.0, 0.1))[0] == pytest.approx(5.0)
    reference.progress = 34.0
    assert reference.nearest((5.0, 0.1))[0] == pytest.approx(34.9)


def test_the_reference_moves_on_at_the_speed_and_stops_at_the_end() -> None:
    reference = ReferencePath(CORNER, 2.0)
    ahead = reference.ahead((1.0, 0.2, 0.0), 40, 0.25)
    assert ahead[:4, 0] == pytest.approx([1.5, 2.0, 2.5, 3.0])
    assert ahead[-1, :2] == pytest.approx((4.0, 6.0))
    assert reference.progress == pytest.approx(1.0)


def test_yaws_are_near_the_robots_however_often_it_has_turned() -> None:
    ahead = ReferencePath(CORNER, 1.0).ahead((1.0, 0.0, 6.0 * math.pi + 0.1), 3, 0.1)
    assert ahead[:, 2] == pytest.approx(6.0 * math.pi)


@pytest.mark.parametrize(
    ("points", "speed", "message"),
    [
        (np.zeros((3, 2)), 1.0, "two different points"),
        (np.zeros((3, 3)), 1.0, "rows of finite x, y"),
        (np.array([[0.0, 0.0], [np.nan, 1.0]]), 1.0, "rows of finite x, y"),
        (CORNER, 0.0, "the speed is 0"),
    ],
)
def test_what_is_no_path_is_refused(points: np.ndarray, speed: float, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        ReferencePath(points, speed)
