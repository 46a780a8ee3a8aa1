# SPDX-License-Identifier: Apache-2.0
"""Runs are learned in the order in which they were driven, from inputs without repeats."""

from dataclasses import replace

import numpy as np
from sample_logs import Drive, simulated_run

from slipwise.calibration.prepared_run import prepare_run
from slipwise.logs import Log, Run

EPOCH = 1.7e9


def shifted(run: Run, seconds: float, name: str) -> Run:
    """The same run, `seconds` later."""
    assert run.wheels is not None
    wheels = replace(run.wheels, t=run.wheels.t + seconds)
    return replace(run, name=name, wheels=wheels, poses=replace(run.poses, t=run.poses.t + seconds))


def test_runs_with_times_of_day_are_learned_in_time_whatever_the_order_of_the_files() -> None:
    run = simulated_run(Drive(seconds=10.0))
    log = Log(runs=(shifted(run, EPOCH + 500.0, "afternoon"), shifted(run, EPOCH, "morning")))
    assert [item.run.name for item in prepare_run(log, "wheel")] == ["morning", "afternoon"]
    assert [item.index for item in prepare_run(log, "wheel")] == [1, 0]


def test_runs_that_count_from_their_own_start_keep_the_order_of_the_files() -> None:
    run = simulated_run(Drive(seconds=10.0))
    log = Log(runs=(shifted(run, 5.0, "first"), shifted(run, 0.0, "second")))
    drive = prepare_run(log, "wheel")
    assert [item.run.name for item in drive] == ["first", "second"]
    assert np.all(drive[1].inputs.t < 20.0)
