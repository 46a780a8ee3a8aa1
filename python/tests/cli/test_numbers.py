# SPDX-License-Identifier: Apache-2.0
"""Several numbers in one option are read, or refused with an example."""

from __future__ import annotations

import math

import pytest

from slipwise.cli.numbers import grade_of, pose_of
from slipwise.errors import SettingsError
from slipwise.ground import Grade


def test_a_pose_and_a_grade_are_read() -> None:
    assert pose_of("1.5, -2,0.3", "--from") == (1.5, -2.0, 0.3)
    assert grade_of("8,-90") == Grade(math.radians(8.0), math.radians(-90.0))
    assert grade_of(None) is None


def test_what_is_no_grade_is_refused_with_an_example(subtests: pytest.Subtests) -> None:
    for text in ["", "8", "8,-90,1", "steep,0", "nan,0"]:
        with (
            subtests.test(text=text),
            pytest.raises(
                SettingsError, match=r"is not a grade \(--grade\): give SLOPE,DOWNHILL, such as 8,-90"
            ),
        ):
            grade_of(text)


def test_a_slope_on_which_no_wheel_holds_is_refused() -> None:
    with pytest.raises(SettingsError, match="give a slope from 0"):
        grade_of("75,0")
