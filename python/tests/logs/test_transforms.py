# SPDX-License-Identifier: Apache-2.0
"""What TF knows of the robot's pose, and what it does not show."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats, Ints
from slipwise.logs.transforms import Edge, describe_transforms

STILL = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (50, 1))
STAMPS = np.arange(50, dtype=np.int64) * 100_000_000


def moving(every: int = 1) -> Floats:
    rows = STILL.copy()
    rows[:, 0] = np.arange(50) // every
    return rows


def tree(corrections: Floats) -> dict[Edge, tuple[Ints, Floats]]:
    return {("map", "odom"): (STAMPS, corrections), ("odom", "base_link"): (STAMPS, moving())}


def test_a_localiser_that_corrects_at_each_pose_needs_no_warning() -> None:
    found = describe_transforms("/tf", tree(moving()), None, None)
    assert (found.frames, found.samples, found.warning) == (("map", "base_link"), 50, "")


def test_rare_corrections_are_pointed_out() -> None:
    found = describe_transforms("/tf", tree(moving(every=10)), None, None)
    assert found.warning.startswith("map -> odom changes 4 times in 50 poses")
    assert not found.odometry_alone


def test_a_map_that_never_moves_the_odometry_is_odometry_alone() -> None:
    found = describe_transforms("/tf", tree(STILL), None, None)
    assert found.odometry_alone
    assert "odom -> base_link alone" in found.warning


def test_frames_that_are_missing_or_not_connected_are_said() -> None:
    assert (
        "it has no usual frames, but a -> b"
        in describe_transforms("/tf", {("a", "b"): tree(STILL)[("map", "odom")]}, None, None).problem
    )
    apart = {("map", "lidar"): (STAMPS, moving()), ("odom", "base_link"): (STAMPS, moving())}
    assert "does not connect" in describe_transforms("/tf", apart, None, None).problem
