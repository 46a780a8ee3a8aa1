# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/following.py`: one step of yaw slip, followed by branches."""

from __future__ import annotations

import pytest
from benchmarks.following import Job, learned, within


@pytest.mark.parametrize("name", ["wheel", "command"])
def test_branches_follow_a_step_within_ten_seconds(name: str) -> None:
    found = {way: learned(Job("smooth", name, 0.5, 1, way, 0.0)) for way in ("branches", "unwatched")}
    before, after = (
        {way: within([each], "heading", *since).mean() for way, each in found.items()}
        for since in ((-200.0, -5.0), (10.0, 60.0))
    )
    assert before["branches"] < 1.02 * before["unwatched"]
    assert after["branches"] < 0.2 * after["unwatched"]
    assert after["branches"] < 2.0 * before["branches"]
