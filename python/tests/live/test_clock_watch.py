# SPDX-License-Identifier: Apache-2.0
"""Odd stamps are told from a clock that was set."""

from __future__ import annotations

import math

from slipwise.live.clock_watch import ClockWatch
from slipwise.live.samples import Wheels


def wheels(t: float) -> Wheels:
    return Wheels(t, 0.5, 0.0)


def taken(watch: ClockWatch, *stamps: float) -> tuple[list[float], list[float]]:
    """What passed, and by how much the clock was set back, each time."""
    passed, back = [], []
    for t in stamps:
        passed += [sample.t for sample in watch.take(wheels(t))]
        back += [] if watch.set_back_by is None else [watch.set_back_by]
    return passed, back


def test_stamps_in_order_and_a_little_late_pass() -> None:
    passed, back = taken(ClockWatch(), 1.0, 1.1, 0.9, 1.2, 40.0)
    assert passed == [1.0, 1.1, 0.9, 1.2, 40.0]
    assert not back


def test_one_stamp_far_behind_is_dropped_and_counted() -> None:
    watch = ClockWatch()
    passed, back = taken(watch, 1e4, 10.0, 1e4 + 0.1, 1e4 + 0.2)
    assert passed == [1e4, 1e4 + 0.1, 1e4 + 0.2]
    assert watch.dropped == 1
    assert not back


def test_several_stamps_behind_that_agree_are_a_clock_that_was_set_back() -> None:
    watch = ClockWatch()
    later = [5000.0 + 0.1 * k for k in range(6)]
    passed, back = taken(watch, 8600.0, 8600.1, *later)
    assert passed == [8600.0, 8600.1, *later]
    assert back == [8600.1 - 5000.0]
    assert watch.newest == later[-1]
    assert watch.dropped == 0


def test_one_stamp_far_ahead_does_not_stop_the_clock() -> None:
    watch = ClockWatch()
    passed, _ = taken(watch, 100.0, 3700.0, 100.1, 100.2)
    assert passed == [100.0, 100.1, 100.2]
    assert watch.dropped == 1


def test_a_gap_in_a_recording_loses_nothing() -> None:
    watch = ClockWatch()
    passed, _ = taken(watch, 100.0, 900.0, 900.02, 900.04)
    assert passed == [100.0, 900.0, 900.02, 900.04]
    assert watch.dropped == 0


def test_what_is_no_stamp_goes_to_the_learner_which_counts_it() -> None:
    watch = ClockWatch()
    assert len(watch.take(wheels(math.nan))) == 1
    assert watch.newest == -math.inf
