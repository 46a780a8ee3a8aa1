# SPDX-License-Identifier: Apache-2.0
"""An input is known until it is as old as the setting says, wherever inputs are held."""

import numpy as np
from sample_logs import held, steady_run

from slipwise.calibration import make_settings
from slipwise.calibration.prepared_run import collect_windows, prepare_run
from slipwise.inspection import coverage_map
from slipwise.logs import Inputs, Log, Run
from slipwise.logs.held import HeldSum, held_for
from slipwise.logs.motion_windows import evidence_of, motion_windows
from slipwise.logs.quality import find_jumps

SLOW = held(np.arange(0.0, 20.5, 1.0), v=1.0)  # a command every second


def slow_run() -> Run:
    """Commands at 1 Hz that the robot follows, with poses at 10 Hz."""
    run = steady_run()
    return Run(run.name, commands=SLOW, wheels=None, poses=run.poses)


def test_a_sum_counts_an_input_until_it_is_too_old() -> None:
    start, stop = np.array([0.0]), np.array([10.0])
    assert HeldSum.of(SLOW, SLOW.v, 0.5).between(start, stop).tolist() == [5.0]
    assert HeldSum.of(SLOW, SLOW.v, 0.5).known(start, stop).tolist() == [5.0]
    assert HeldSum.of(SLOW, SLOW.v, 2.0).between(start, stop).tolist() == [10.0]


def test_poses_are_compared_with_inputs_that_the_setting_calls_known() -> None:
    few, more = (evidence_of([slow_run()], known).windows for known in (0.5, 1.5))
    assert len(motion_windows(few, "command")) == 0
    assert len(motion_windows(more, "command")) > 5


def test_driven_distances_and_maps_obey_the_setting() -> None:
    rules = make_settings({"segment": {"unknown_after": 1.5}}).rules()
    windows = collect_windows(prepare_run(Log(runs=(slow_run(),)), "command"), 2.0, rules)
    np.testing.assert_allclose(windows.distances(), windows.end - windows.start, atol=1e-6)
    assert "20 s in all" in coverage_map([SLOW], unknown_after=1.5)[-1]
    assert "10 s in all" in coverage_map([SLOW], unknown_after=0.5)[-1]
    assert held_for(SLOW, 0.25).max() == 0.25


def test_the_reach_of_a_robot_grows_with_what_is_known_of_its_inputs() -> None:
    inputs = Inputs(
        t=np.array([0.0, 0.1, 10.0]), v=np.array([0.0, 5.0, 0.0]), vy=np.zeros(3), omega=np.zeros(3)
    )
    run = steady_run(10.0, v=4.0, pose_rate=0.5)
    assert not find_jumps(run.poses, inputs, 20.0).starts.any()
