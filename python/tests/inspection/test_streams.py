# SPDX-License-Identifier: Apache-2.0
"""Streams are counted as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_logs import held, steady_run, with_poses

from slipwise.inspection.inspect_log import streams_of
from slipwise.logs import Log, empty_poses
from slipwise.segments import WindowRules


def test_rates_durations_and_counts_add_up_over_runs() -> None:
    log = Log(runs=(steady_run(20.0, name="a"), steady_run(10.0, name="b")))
    commands, wheels, poses = streams_of(log, WindowRules())
    assert (commands.name, wheels.name, poses.name) == ("commands", "wheels", "poses")
    assert (poses.runs, poses.samples, poses.frames) == (2, 201 + 101, 2)
    assert np.isclose(poses.rate, 10.0)
    assert np.isclose(commands.rate, 20.0)
    assert np.isclose(commands.seconds, 30.0)
    assert (commands.gaps, poses.gaps) == (0, 0)


def test_gaps_are_counted_and_the_longest_is_named() -> None:
    run = steady_run(20.0)
    t = run.poses.t
    run = with_poses(run, run.poses.select(~((t > 5.0) & (t < 6.0)) & ~((t > 9.0) & (t < 12.0))))
    poses = streams_of(Log(runs=(run,)), WindowRules())[-1]
    assert poses.gaps == 2
    assert np.isclose(poses.longest_gap, 3.0)


def test_what_is_missing_is_not_listed() -> None:
    run = replace(steady_run(5.0), wheels=None, poses=empty_poses())
    assert [stream.name for stream in streams_of(Log(runs=(run,)), WindowRules())] == ["commands"]


def test_a_single_sample_has_no_rate() -> None:
    run = replace(steady_run(5.0), commands=held([1.0]), wheels=None, poses=empty_poses())
    (commands,) = streams_of(Log(runs=(run,)), WindowRules())
    assert np.isnan(commands.rate)
    assert (commands.samples, commands.gaps, commands.seconds) == (1, 0, 0.0)
