# SPDX-License-Identifier: Apache-2.0
"""Nodes are told what they take while they run and never a limit; what wants a restart is said once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from sample_models import LIMITS, make_model, named

from slipwise.calibration.live_table import ApplyTable
from slipwise.export.ros_tables import DISTROS, TABLES
from slipwise.live.handover import Handover
from slipwise.live.outputs import AppliedParameters
from slipwise.live.said import Said

WHEEL = make_model(named("edd-2", lon__V=-0.05, ang__w=-0.4))
COMMAND = make_model(replace(named("edd-2", ang__w=-0.4), commands=True, limits=LIMITS))


def handed(
    model: Any, times: int = 31, distro: str = "", **rules: Any
) -> tuple[list[AppliedParameters], list[str]]:
    """What nodes were told, and what was said."""
    said = Said()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DISTRO", distro)  # empty: as without it
        handover = Handover(ApplyTable(mode="auto", set_parameters=True, **rules), said)
    told = [each for k in range(times) for each in handover.hand_on(10.0 * k, model)]
    handover.finish(1000.0)
    return told, [note.text for note in said.take_new()]


def test_no_node_is_told_a_limit_or_what_it_takes_at_a_restart_alone(
    tmp_path: Path, subtests: pytest.Subtests
) -> None:
    for distro in DISTROS:
        with subtests.test(distro=distro):
            for model in (WHEEL, COMMAND):
                told, _ = handed(model, 2, distro, targets=list(TABLES), folder=str(tmp_path))
                for each in told:
                    rows = TABLES[each.target].of_distro(distro if TABLES[each.target].differs else None)
                    assert each.values
                    assert all(
                        rows[name].effect == "at once" and not rows[name].limit for name in each.values
                    )
                for file in tmp_path.glob("*.yaml"):
                    if file.name != "model.yaml":
                        assert "velocity" not in str(yaml.safe_load(file.read_text()))
                        assert "wz_max" not in str(yaml.safe_load(file.read_text()))


def test_what_wants_a_restart_is_said_once_with_its_file(tmp_path: Path) -> None:
    told, said = handed(WHEEL, distro="jazzy", targets=["diff-drive"], folder=str(tmp_path))
    assert told == []
    (text,) = [text for text in said if "restarted" in text]
    assert "wheel_separation_multiplier" in text
    assert str(tmp_path / "diff_drive_controller.yaml") in text
    assert "~/odometry" in text
    assert not any("handed on" in text for text in said)


def test_a_filter_without_a_callback_is_not_told(tmp_path: Path) -> None:
    told, said = handed(COMMAND, targets=["robot-localization"], folder=str(tmp_path))
    assert told == []
    (text,) = [text for text in said if "no parameter callback" in text]
    assert "Restart it with" in text


def test_a_delay_reaches_a_controller_that_has_it() -> None:
    told, _ = handed(COMMAND, 1, "lyrical", targets=["mppi"])
    assert told[0].node == "/controller_server"
    assert {"FollowPath.model_delay_vx", "FollowPath.model_delay_wz"} <= told[0].values.keys()
    assert not any("_max" in name or "motion_model" in name for name in told[0].values)


def test_a_target_that_got_nothing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    _, said = handed(COMMAND, targets=["mppi", "diff-drive"])
    assert sum("mppi gets nothing: the parameters of Nav2" in text for text in said) == 1
    assert sum("diff-drive gets nothing" in text for text in said) == 1
    assert said[-1] == "mppi, diff-drive never got parameters"
    _, said = handed(COMMAND, 0, targets=["mppi"])
    assert said == ["mppi never got parameters"]
