# SPDX-License-Identifier: Apache-2.0
"""Two robots on one topic are told from one robot with faults."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.logs.findings.sources import CLOSED_FOR, SourceWatch

FAR = (0.75, 0.75)


def test_one_robot_is_one_source_with_noise_outliers_and_a_jump() -> None:
    rng, watch = np.random.default_rng(1), SourceWatch(FAR)
    for k in range(2000):
        t = 0.05 * k
        x, y = np.array([np.cos(0.2 * t), np.sin(0.2 * t)]) * 5.0 + rng.normal(0.0, 0.03, 2)
        if k % 101 == 50:
            x += 30.0
        if k > 1000:
            y += 12.0  # relocalised
        assert not watch.take(t, (x, y))


@pytest.mark.parametrize("every", [1, 2, 3])
def test_a_second_robot_is_noticed_within_a_second_and_forgotten_after_it_left(every: int) -> None:
    watch, noticed = SourceWatch(FAR), None
    for k in range(200):
        t = 0.05 * k
        spoken = watch.take(t, (0.01 * k, 0.0))
        if k % every == 0:
            spoken = watch.take(t + 0.01, (40.0 - 0.01 * k, 7.0)) or spoken
        noticed = noticed or (t if spoken else None)
    assert noticed is not None
    assert noticed < 1.0
    left = 0.05 * 200
    later = [watch.take(left + 0.05 * k, (2.0 + 0.01 * k, 0.0)) for k in range(200)]
    assert not later[int((CLOSED_FOR + 3.0) / 0.05)]


@pytest.mark.parametrize(("every", "second"), [(20, False), (10, False), (2, True)])
def test_one_value_that_stands_for_no_pose_is_an_outlier_where_it_is_rare(every: int, second: bool) -> None:
    watch = SourceWatch(FAR)
    rows = [(-1.0, -1.0) if k % every == 0 else (5.0 + 0.01 * k, 0.0) for k in range(400)]
    assert any(watch.take(0.05 * k, row) for k, row in enumerate(rows)) == second


def test_wheel_speeds_with_much_noise_are_one_source() -> None:
    rng, watch = np.random.default_rng(4), SourceWatch((0.25, 0.25, 0.5), relative=0.1)
    noisy = (60.0 + 5.0 * np.sin(0.01 * k) + 0.4 * rng.standard_normal() for k in range(5000))
    assert not any(watch.take(0.05 * k, (v, 0.0, 0.0)) for k, v in enumerate(noisy))


def test_a_pose_that_is_no_number_says_nothing() -> None:
    watch = SourceWatch(FAR)
    assert not watch.take(0.0, (float("nan"), 0.0))


@pytest.mark.parametrize("second", [0.0, 40.0])
def test_a_whole_stream_is_judged_as_its_samples_are(second: float) -> None:
    rng, t = np.random.default_rng(2), 0.05 * np.arange(2000)
    rows = np.column_stack((t, rng.normal(0.0, 0.1, 2000)))
    rows[1000::2, 0] += second
    rows[300] += 30.0  # an outlier
    watch = SourceWatch(FAR)
    seen = [stamp for stamp, row in zip(t, rows, strict=True) if watch.take(stamp, tuple(row))]
    first = SourceWatch(FAR).first(t, rows)
    assert first == (seen[0] if seen else None)
    assert (first is None) == (second == 0.0)
    assert SourceWatch(FAR).first(t[:300], rows[:300]) is None
