# SPDX-License-Identifier: Apache-2.0
"""Holds end where the command changes, is unknown, or stops; standing still is none."""

from __future__ import annotations

import numpy as np

from slipwise.logs import Inputs
from slipwise_thesis.steady import HoldRules, find_holds


def inputs(t: np.ndarray, v: list[float], omega: list[float]) -> Inputs:
    return Inputs(t=t, v=np.array(v), vy=np.zeros(len(t)), omega=np.array(omega))


def test_a_hold_lasts_until_the_next_command() -> None:
    t = np.arange(6) * 0.1
    first, second = find_holds(inputs(t, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0], [0.1] * 6))
    assert (first.start, first.v, first.omega) == (0.0, 1.0, 0.1)
    assert first.end == second.start == t[3]
    assert second.end == t[5]


def test_jitter_within_the_tolerance_does_not_end_a_hold() -> None:
    t = np.arange(4) * 0.1
    (hold,) = find_holds(inputs(t, [1.0, 1.009, 0.992, 1.0], [0.0] * 4))
    assert hold.end == t[3]
    assert len(find_holds(inputs(t, [1.0, 1.0, 1.02, 1.02], [0.0] * 4))) == 2


def test_a_gap_makes_the_command_unknown() -> None:
    first, second = find_holds(inputs(np.array([0.0, 0.1, 5.0, 5.1]), [1.0] * 4, [0.0] * 4))
    assert (first.end, second.start) == (0.6, 5.0)


def test_standing_still_is_no_hold_but_turning_in_place_is() -> None:
    t = np.arange(6) * 0.1
    (hold,) = find_holds(inputs(t, [0.0] * 6, [0.0, 0.0, 0.0, 0.7, 0.7, 0.7]))
    assert (hold.v, hold.omega) == (0.0, 0.7)


def test_one_sample_or_none_is_no_hold() -> None:
    assert find_holds(inputs(np.array([0.0]), [1.0], [0.0]), HoldRules()) == ()
    assert find_holds(inputs(np.empty(0), [], [])) == ()
