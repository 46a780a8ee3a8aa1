# SPDX-License-Identifier: Apache-2.0
"""The map of slip by place."""

from __future__ import annotations

from reporting.drives_in_circles import circling
from reporting.page_parts import figures_of

from slipwise.reporting.slip_place_map import place_maps


def test_squares_are_the_larger_the_surer() -> None:
    log, part = circling()
    forward, yaw = place_maps(log, part, key="place", name="a & b")
    squares = figures_of(forward.html())["figure-place-forward"]["data"][1]
    sds = [row[0] for row in squares["customdata"]]
    sizes = squares["marker"]["size"]
    assert sizes[sds.index(min(sds))] == max(sizes)
    assert sizes[sds.index(max(sds))] == min(sizes)
    assert "a &amp; b" in yaw.html()
    assert "correlate by" in forward.caption


def test_a_path_that_never_returns_has_no_map() -> None:
    log, part = circling(laps=1)
    assert place_maps(log, part, key="place") == []
    assert place_maps(log, None, key="place") == []
