# SPDX-License-Identifier: Apache-2.0
"""Ellipses stand along the path, as large as the covariance says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from live.sample_outputs import straight_path

from slipwise.live.watch.path_ellipses import path_ellipses


def test_the_last_one_is_at_the_end_and_as_large_as_its_covariance() -> None:
    path = straight_path(points=40)
    outlines = path_ellipses(path)
    assert len(outlines) == 6
    radius = math.sqrt(-2.0 * math.log(0.05))
    middle = 0.5 * (outlines[-1].min(axis=0) + outlines[-1].max(axis=0))
    assert middle == pytest.approx(path.poses[-1, :2], abs=1e-6)
    half = 0.5 * np.ptp(outlines[-1], axis=0)
    assert half == pytest.approx(radius * np.sqrt([3e-3, 12e-3]), rel=1e-2)
    assert outlines[-1][0] == pytest.approx(outlines[-1][-1])


def test_few_poses_have_as_many_and_none_have_none() -> None:
    assert len(path_ellipses(straight_path(points=2))) == 2
    path = straight_path(points=3)
    path.covariance[2] = np.nan
    assert len(path_ellipses(path)) == 2
    empty = straight_path(points=3)
    object.__setattr__(empty, "poses", empty.poses[:0])
    assert path_ellipses(empty) == []
