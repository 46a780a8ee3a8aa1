# SPDX-License-Identifier: Apache-2.0
"""`benchmarks/stuck.py` finds a robot that is held, says what it was asked and did, and no other."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import stuck
from data_sets import data_sets

import slipwise
from slipwise.logs.log import Log, Run


def held(run: Run, begin: float) -> Run:
    """Return a run whose robot does not move any more after some time [s]."""
    poses = run.poses
    t = poses.t - poses.t[0]
    source = np.minimum(np.arange(len(t)), np.searchsorted(t, begin))
    still = replace(poses, x=poses.x[source], y=poses.y[source], yaw=poses.yaw[source])
    return replace(run, poses=still)


def test_what_inputs_ask_is_held_between_rows_and_cut_at_the_span() -> None:
    inputs = np.array([[0.0, 1.0, 0.0, 0.5], [1.0, 0.0, 2.0, 0.0], [2.0, 3.0, 4.0, -1.0]])
    assert stuck.asked_of(inputs, 0.5, 2.5) == pytest.approx((0.5 + 2.0 + 2.5, 0.25 + 0.5))


def test_what_poses_do_is_from_the_first_to_the_last_of_the_span() -> None:
    poses = np.array([[0.0, 9.0, 9.0, 9.0, 0], [1.0, 0.0, 0.0, 3.1, 0], [2.0, 3.0, 4.0, -3.1, 0]])
    assert stuck.done_of(poses, 0.5, 2.5) == pytest.approx((5.0, 2.0 * np.pi - 6.2))
    assert stuck.done_of(poses, 5.0, 6.0) == (0.0, 0.0)


def test_a_robot_that_did_a_fifth_of_one_of_two_is_not_still() -> None:
    alarm = stuck.Alarm("log", "wheel", 0, 1.0, 2.0, asked=(1.0, 1.0), done=(0.05, 0.3))
    assert not alarm.still
    assert stuck.Alarm("log", "wheel", 0, 1.0, 2.0, asked=(1.0, 0.05), done=(0.05, 0.3)).still


@pytest.mark.slow
def test_a_robot_that_is_held_is_found_and_one_that_drives_is_not(data: Path) -> None:
    (data_set, _) = data_sets(data)
    log: Log = slipwise.open_log(data_set.path)
    (run,) = log.runs
    for input_name in ("wheel", "command"):
        assert not stuck.watched(data_set, log, input_name).alarms
        held_log = replace(log, runs=(held(run, 50.0),))
        alarms = stuck.watched(data_set, held_log, input_name).alarms
        assert alarms
        assert all(alarm.still for alarm in alarms)
        assert 50.0 < alarms[0].begin < 53.0


@pytest.mark.slow
def test_all_logs_are_written_to_the_file(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "stuck.json"
    monkeypatch.setattr("sys.argv", ["stuck.py", "--only", "first", "--json", str(path)])
    assert stuck.main() == 0
    assert "0 alarms in 2 minutes" in capsys.readouterr().out
    assert [log["input"] for log in json.loads(path.read_text(encoding="utf-8"))["logs"]] == [
        "wheel",
        "command",
    ]
