# SPDX-License-Identifier: Apache-2.0
"""A method beats the baseline only if no error is worse, and one is better, beyond chance."""

from __future__ import annotations

import math

import pytest
from judgements import BETTER, judged

NAN = (math.nan,) * 3


def test_the_baseline_is_beaten_only_beyond_chance(subtests: pytest.Subtests) -> None:
    for position, heading, beats in [
        (BETTER, BETTER, True),
        (BETTER, (1.0, 0.8, 1.2), True),  # heading is as before
        (BETTER, (1.005, 0.8, 1.2), True),  # the same, as it prints
        (BETTER, (1.1, 0.8, 1.4), True),  # worse on the segments seen, but by chance
        (BETTER, (1.016, 0.978, 1.055), True),  # a straight drive, whose headings are noise
        (BETTER, (1.1, 1.05, 1.2), False),  # beyond chance
        (BETTER, (1.3, 1.1, 1.5), False),  # clearly worse
        ((1.54, 0.6, 3.0), (0.1, 0.05, 0.2), False),  # five metres in the place of three, with few segments
        ((0.95, 0.8, 1.1), (0.97, 0.9, 1.05), False),  # nothing beyond chance
        ((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), False),
        (NAN, BETTER, True),  # the baseline's position is never wrong, nor is this one's
        (NAN, NAN, False),
    ]:
        with subtests.test(position=position, heading=heading, beats=beats):
            assert judged(position, heading).beats_baseline is beats
            assert bool(judged(position, heading).fault()) is not beats


def test_fewer_than_four_segments_are_too_few() -> None:
    assert judged(BETTER, BETTER, windows=3).too_short
    assert not judged(BETTER, BETTER, windows=4).too_short


def test_an_error_that_is_worse_is_told_from_one_by_chance() -> None:
    assert judged((1.3, 0.8, 2.0), BETTER).worse
    assert judged((1.1, 1.05, 1.2), BETTER).worse
    assert not judged((1.1, 0.9, 1.3), BETTER).worse
    assert not judged(BETTER, BETTER).worse
