# SPDX-License-Identifier: Apache-2.0
"""Alarms are early, late or false as they are counted by hand."""

from __future__ import annotations

import numpy as np
from alarm_scores import LONGEST, WARM_UP, Course, Point, at_budget, delays, false_alarms


def course(*changes: int, windows: int = 200) -> Course:
    return Course(np.zeros(windows), np.zeros((windows, 2)), np.zeros(windows), changes)


def test_a_change_is_found_by_the_first_alarm_after_it_and_before_the_next() -> None:
    assert delays(course(100, 150), [99, 104, 160], offline=False) == [5, 11]
    assert delays(course(100, 150), [99], offline=False) == [LONGEST, LONGEST]


def test_who_sees_the_whole_drive_is_as_far_off_as_his_nearest_alarm() -> None:
    assert delays(course(100), [97, 110], offline=True) == [3]


def test_only_alarms_before_the_first_change_are_false() -> None:
    given = course(100), [WARM_UP - 1, WARM_UP, 99, 100, 180]
    assert false_alarms(*given, offline=False) == (2, 100 - WARM_UP)
    assert false_alarms(course(100), [WARM_UP, 97], offline=True) == (1, 100 - LONGEST - WARM_UP)
    assert false_alarms(course(), [150], offline=False) == (1, 200 - WARM_UP)


def test_of_settings_with_few_false_alarms_the_soonest_counts() -> None:
    slow, soon = Point("f", "slow", 0.5, 9.0, 1.0), Point("f", "soon", 5.0, 2.0, 1.0)
    assert at_budget([slow, soon], 1.0) == slow
    assert at_budget([slow, soon], 10.0) == soon
    assert at_budget([soon], 1.0) is None
