# SPDX-License-Identifier: Apache-2.0
"""The text map shows where a robot was driven."""

from __future__ import annotations

import numpy as np
from sample_logs import held

from slipwise.inspection.coverage_map import MapSize, coverage_map, held_for
from slipwise.logs import Inputs

SMALL = MapSize(columns=5, rows=3)


def _inputs(v: list[float], omega: list[float], step: float = 0.1) -> Inputs:
    size = len(v)
    return Inputs(t=np.arange(size) * step, v=np.array(v), vy=np.zeros(size), omega=np.array(omega))


def test_speed_grows_to_the_right_and_yaw_rate_upwards() -> None:
    lines = coverage_map([_inputs([0.0] * 5 + [2.0] * 5, [-1.0] * 5 + [1.0] * 5)], size=SMALL)
    top, middle, bottom = (line[8:13] for line in lines[1:4])
    assert (top, middle, bottom) == ("    ▒", "     ", "▒    ")


def test_the_axes_have_numbers() -> None:
    lines = coverage_map([_inputs([0.0, 2.0, 2.0], [-1.0, 1.0, 1.0])], size=MapSize(columns=21, rows=3))
    assert [line[:6] for line in lines[1:4]] == [" +1.00", " +0.00", " -1.00"]
    assert lines[5].split() == ["+0.00", "+1.00", "+2.00", "V", "[m/s]"]


def test_longer_stays_are_darker() -> None:
    times = {0.0: 20.0, 1.0: 5.0, 2.0: 0.5, 3.0: 0.05, 4.0: 0.0}
    v = np.concatenate([np.full(round(seconds / 0.05), speed) for speed, seconds in times.items()])
    row = coverage_map([_inputs([*v.tolist(), 4.0], [0.0] * (len(v) + 1), 0.05)], size=SMALL)[2]
    assert row[8:13] == "█▓▒░ "


def test_every_line_of_the_map_is_equally_wide() -> None:
    lines = coverage_map([held(np.arange(0.0, 5.0, 0.1), v=1.0, omega=0.3)])
    assert len({len(line) for line in lines[1:15]}) == 1


def test_no_inputs_are_no_error() -> None:
    assert coverage_map([]) == ("There are no inputs to draw.",)


def test_an_old_input_does_not_count_as_held() -> None:
    assert held_for(held([0.0, 0.1, 10.0]), 0.5).tolist() == [0.1, 0.5, 0.0]
