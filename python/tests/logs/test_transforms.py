# SPDX-License-Identifier: Apache-2.0
"""What TF knows of the robot's pose, and what it does not show."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats
from slipwise.logs.transforms import Edge, Edges, Moves, chain_poses, describe_transforms

STILL = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (50, 1))
STAMPS = np.arange(50, dtype=np.int64) * 100_000_000


def moving(every: int = 1) -> Floats:
    rows = STILL.copy()
    rows[:, 0] = np.arange(50) // every
    return rows


def tree(corrections: Floats, prefix: str = "") -> dict[Edge, Moves]:
    return {
        ("map", f"{prefix}odom"): Moves(STAMPS, corrections, STAMPS),
        (f"{prefix}odom", f"{prefix}base_link"): Moves(STAMPS, moving(), STAMPS),
    }


def test_a_localiser_that_corrects_at_each_pose_needs_no_warning() -> None:
    found = describe_transforms("/tf", tree(moving()), None, None)
    assert (found.frames, found.samples, found.warning) == (("map", "base_link"), 50, "")
    assert chain_poses(tree(moving()), "map", "base_link").notes == ()


def test_between_corrections_nothing_is_measured() -> None:
    found = chain_poses(tree(moving(every=10)), "map", "base_link")
    np.testing.assert_array_equal(found.stamps, STAMPS[10::10])
    assert "map -> odom changes 4 times in 50 transforms" in found.notes[0]
    assert describe_transforms("/tf", tree(moving(every=10)), None, None).samples == 4


def test_frames_of_one_robot_may_have_its_name_before_them() -> None:
    found = describe_transforms("/tf", tree(moving(), "tb3/"), None, None)
    assert (found.frames, found.samples) == (("map", "tb3/base_link"), 50)
    both: Edges = tree(moving(), "tb1/") | tree(moving(), "tb2/")
    assert "it has no usual frames" in describe_transforms("/tf", both, None, None).problem
    assert describe_transforms("/tf", both, None, "tb2/base_link").frames == ("map", "tb2/base_link")


def test_a_map_that_never_moves_the_odometry_is_odometry_alone() -> None:
    found = describe_transforms("/tf", tree(STILL), None, None)
    assert found.odometry_alone
    assert "odom -> base_link alone" in found.warning


def test_frames_that_are_missing_or_not_connected_are_said() -> None:
    assert (
        "it has no usual frames, but a -> b"
        in describe_transforms("/tf", {("a", "b"): tree(STILL)[("map", "odom")]}, None, None).problem
    )
    own = Moves(STAMPS, moving(), STAMPS)
    apart = {("map", "lidar"): own, ("odom", "base_link"): own}
    assert "does not connect" in describe_transforms("/tf", apart, None, None).problem
