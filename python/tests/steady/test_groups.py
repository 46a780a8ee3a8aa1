# SPDX-License-Identifier: Apache-2.0
"""Groups are by speed and curvature; at speed zero by yaw rate, never by a division."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.steady import GroupRules, SteadyPath, group_paths


def path(v: float, omega: float) -> SteadyPath:
    return SteadyPath("r", 0.0, (v, 0.0, omega), np.array([0.0, 1.0]), np.zeros((2, 3)))


def test_like_commands_share_a_group_and_others_do_not() -> None:
    groups = group_paths([path(1.0, 0.5), path(2.0, 1.0), path(1.01, 0.5), path(1.0, -0.5), path(-1.0, -0.5)])
    assert [(round(g.v, 3), len(g)) for g in groups] == [(-1.0, 1), (1.0, 1), (1.005, 2), (2.0, 1)]
    assert groups[0].curvature == pytest.approx(0.5)
    assert groups[1].curvature == pytest.approx(-0.5)


@pytest.mark.filterwarnings("error")
def test_curvature_at_zero_speed_is_undefined_and_grouped_as_a_turn_in_place() -> None:
    groups = group_paths([path(0.0, 1.0), path(-0.0, 1.01), path(0.003, 1.0), path(0.0, -1.0)])
    assert [(g.curvature, len(g)) for g in groups] == [(None, 1), (None, 3)]
    assert groups[1].name == "turn in place at 1 rad/s"


def test_no_segments_make_no_groups() -> None:
    assert group_paths([]) == ()


@pytest.mark.parametrize("rules", [GroupRules(speed=-1.0), GroupRules(curvature=np.nan)])
def test_rules_that_make_no_sense_are_refused(rules: GroupRules) -> None:
    with pytest.raises(SettingsError):
        group_paths([path(1.0, 0.5)], rules)
