# SPDX-License-Identifier: Apache-2.0
"""What `benchmarks/live_loop.py` makes of scores: means, medians, ratios, and their intervals."""

from __future__ import annotations

import json
import math

import live_loop
import numpy as np
import pytest

from slipwise_sim.demo.closed_loop import EACH_FLOOR, LIVE, VARIANTS, VENDOR
from slipwise_sim.demo.tracking_score import Tracking


def score(mean: float, recovery: float) -> Tracking:
    """Return a drive's scores."""
    return Tracking(mean, 1.2 * mean, 3.0 * mean, 100.0, True, (mean, mean, 2.0 * mean), (recovery, recovery))


def scores(seeds: int) -> dict[int, dict[str, Tracking]]:
    """Return scores in which the live learner has a fifth of the vendor's error."""
    return {
        seed: {
            name: score(
                (0.5 if name == VENDOR else 0.1) * (1.0 + 0.1 * seed), math.inf if name == VENDOR else 7.0
            )
            for name in VARIANTS
        }
        for seed in range(seeds)
    }


def test_ratios_are_of_means_and_lie_in_their_intervals() -> None:
    found = live_loop.summary(scores(5))
    assert found["to_vendor"][LIVE] == pytest.approx([0.2, 0.2, 0.2])
    assert found["to_each_floor"][LIVE] == pytest.approx([1.0, 1.0, 1.0])
    mean, low, high = found["mean"][EACH_FLOOR]
    assert mean == pytest.approx(0.12)
    assert 0.1 <= low < mean < high <= 0.14


def test_a_median_stands_where_some_never_recover() -> None:
    values = np.array([3.0, math.inf, 5.0, 4.0, math.inf])
    assert live_loop.interval(values, live_loop.median_of)[0] == 5.0
    assert (
        live_loop.text_of(live_loop.summary(scores(3))["recovery"][0][VENDOR], 1) == "never (never to never)"
    )


def test_what_is_written_is_json() -> None:
    text = json.dumps(live_loop.finite({1: (math.inf, 2.0), "a": [math.nan, "b", 3]}), allow_nan=False)
    assert json.loads(text) == {"1": [None, 2.0], "a": [None, "b", 3]}


def test_tables_have_a_row_for_every_variant() -> None:
    text = live_loop.tables(live_loop.summary(scores(3)), 3)
    for name in VARIANTS:
        assert text.count(f"\n| {name} |") == 2
    assert "| 7.0 (7.0 to 7.0) |" in text
