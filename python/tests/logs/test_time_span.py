# SPDX-License-Identifier: Apache-2.0
"""A log cut to a span keeps what lies in it, and the input that is held at its start."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError, SettingsError
from slipwise.logs import Log, LogOptions, Run, open_log, save_log
from slipwise.logs.open_log import cut_to_span

Drive = Callable[..., Run]


def test_poses_and_inputs_lie_in_the_span_counted_from_the_first_stamp(drive: Drive) -> None:
    log = Log(runs=(drive(start=1000.0),))
    cut = cut_to_span(log, 10.02, 20.0)
    (run,) = cut.runs
    assert run.poses.t[0] == pytest.approx(1010.1)
    assert run.poses.t[-1] == pytest.approx(1020.0)
    assert run.commands is not None
    assert run.commands.t[0] == pytest.approx(1010.0), "the input that is held at the start"
    assert run.commands.t[-1] == pytest.approx(1020.0)
    assert cut.notes == ("only 10.02 s to 20 s of 120.0 s are used",)
    assert len(run.poses.std_xy if run.poses.std_xy is not None else ()) == len(run.poses)


def test_one_end_may_be_open_and_runs_outside_vanish(drive: Drive) -> None:
    log = Log(runs=(drive("a"), drive("b", start=200.0)))
    assert [run.name for run in cut_to_span(log, 150.0, None).runs] == ["b"]
    assert [run.name for run in cut_to_span(log, None, 60.0).runs] == ["a"]
    assert cut_to_span(log, None, None) is log


def test_other_columns_are_cut_alike(run: Run) -> None:
    extra = {"t": run.poses.t, "fuel": np.arange(len(run.poses), dtype=float)}
    cut = cut_to_span(Log(runs=(replace(run, extra=extra),)), 1.0, 2.0).runs[0].extra
    assert cut["t"].tolist() == pytest.approx(run.poses.t[10:21].tolist())
    assert cut["fuel"].tolist() == list(range(10, 21))


def test_nothing_left_is_refused_with_how_long_the_log_is(tmp_path: Path, log: Log) -> None:
    save_log(log, tmp_path / "a.csv")
    with pytest.raises(LogError, match=r"the log is 120 s long; --start 500 leaves no pose .*a\.csv"):
        open_log(tmp_path / "a.csv", options=LogOptions(start=500.0))
    assert len(open_log(tmp_path / "a.csv", options=LogOptions(end=10.0)).runs[0].poses) == 101


@pytest.mark.parametrize(
    "given", [{"start": 5.0, "end": 5.0}, {"end": float("nan")}, {"start": float("inf")}]
)
def test_impossible_spans_are_refused(given: dict[str, float]) -> None:
    with pytest.raises(SettingsError, match=r"is not after --start|must be a number of seconds"):
        LogOptions(**given)  # type: ignore[arg-type]
