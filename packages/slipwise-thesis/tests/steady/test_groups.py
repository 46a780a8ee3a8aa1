# SPDX-License-Identifier: Apache-2.0
"""Groups are by speed and curvature; at speed zero by yaw rate, never by a division."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs import open_log
from slipwise_thesis.steady import GroupRules, SteadyPath, cut_paths, group_paths


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


def test_commanded_curvatures_of_a_log_are_those_of_its_groups(tmp_path: Path) -> None:
    rows, pose = ["t,cmd_v,cmd_curvature,x,y,yaw"], _core.Pose2(0.0, 0.0, 0.0)
    for i in range(240):  # 4 s of each command, poses and commands at 20 Hz
        v, curvature = ((1.0, 0.3), (2.0, 0.3), (1.0, -0.2))[i // 80]
        rows.append(f"{0.05 * i},{v},{curvature},{pose.x},{pose.y},{pose.theta}")
        pose = _core.compose(pose, _core.exp(np.array([0.05 * v, 0.0, 0.05 * v * curvature])))
    table = tmp_path / "arcs.csv"
    table.write_text("\n".join(rows) + "\n")
    (run,) = open_log(table).runs
    assert run.commands is not None
    groups = group_paths(cut_paths(run, run.commands).paths)
    found = [(group.v, group.curvature) for group in groups]
    assert found == [(1.0, pytest.approx(-0.2)), (1.0, pytest.approx(0.3)), (2.0, pytest.approx(0.3))]
