# SPDX-License-Identifier: Apache-2.0
"""The common time axis of several runs."""

from __future__ import annotations

import numpy as np
from reporting.synthetic_results import make_results

from slipwise.reporting.timeline import Timeline, with_breaks


def test_runs_follow_each_other_without_a_pause() -> None:
    timeline = Timeline.of(make_results(runs=3).log)
    at = timeline.at(np.array([0, 1, 2]), np.zeros(3))
    assert np.allclose(at, [0.0, 119.9, 239.8])
    assert [shape["x0"] for shape in timeline.shapes()] == at[1:].tolist()


def test_line_breaks_where_the_run_changes() -> None:
    broken = with_breaks(np.array([0, 0, 1]), np.array([1.0, 2.0, 3.0]))
    assert np.array_equal(broken, [1.0, 2.0, np.nan, 3.0], equal_nan=True)
