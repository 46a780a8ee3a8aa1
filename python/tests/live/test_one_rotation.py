# SPDX-License-Identifier: Apache-2.0
"""One pose gives the bits that it gives among many."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise.live.one_rotation import deviation, rotation_of
from slipwise.logs.bag_streams import deviation_of
from slipwise.logs.rotation import angles_of, unit_quaternions


def test_a_rotation_is_to_the_last_bit_the_one_of_many() -> None:
    rng = np.random.default_rng(8)
    q = rng.normal(size=(3000, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    q[:1500, :2] = 0.0  # in the plane
    q[:1500] /= np.linalg.norm(q[:1500], axis=1, keepdims=True)
    q *= rng.uniform(0.992, 1.008, size=(3000, 1))
    angles = np.column_stack(angles_of(unit_quaternions(q)[0]))
    assert [rotation_of(*row) for row in q.tolist()] == [tuple(row) for row in angles.tolist()]


@pytest.mark.parametrize(
    "q", [(0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.6, 0.9), (math.nan, 0.0, 0.0, 1.0), (1e200, 0.0, 0.0, 1.0)]
)
def test_what_is_no_rotation_is_none(q: tuple[float, float, float, float]) -> None:
    assert rotation_of(*q) is None
    assert not unit_quaternions(np.array([q]))[1][0]


def test_a_deviation_is_the_one_of_many(subtests: pytest.Subtests) -> None:
    for variances in [
        (0.04,),
        (0.04, 0.09),
        (0.0, 0.1),
        (-1.0,),
        (math.nan, 1.0),
        (math.inf,),
        (1e-300, 3e-300),
    ]:
        with subtests.test(variances=variances):
            wanted = float(deviation_of(np.array([variances]))[0])
            assert deviation(*variances) == (wanted if math.isfinite(wanted) else None)
