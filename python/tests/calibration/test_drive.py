# SPDX-License-Identifier: Apache-2.0
"""Runs are learned in the order in which they were driven, from inputs without repeats."""

from dataclasses import replace

import numpy as np
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.calibration.drive import STEP, input_track, prepare_drive, without_repeats
from slipwise.logs import Log, Run
from slipwise.logs.log import Inputs

EPOCH = 1.7e9


def shifted(run: Run, seconds: float, name: str) -> Run:
    """The same run, `seconds` later."""
    assert run.wheels is not None
    wheels = replace(run.wheels, t=run.wheels.t + seconds)
    return replace(run, name=name, wheels=wheels, poses=replace(run.poses, t=run.poses.t + seconds))


def test_runs_with_times_of_day_are_learned_in_time_whatever_the_order_of_the_files() -> None:
    run = simulated_run(Drive(seconds=10.0))
    log = Log(runs=(shifted(run, EPOCH + 500.0, "afternoon"), shifted(run, EPOCH, "morning")))
    assert [item.run.name for item in prepare_drive(log, "wheel")] == ["morning", "afternoon"]
    assert [item.index for item in prepare_drive(log, "wheel")] == [1, 0]


def test_runs_that_count_from_their_own_start_keep_the_order_of_the_files() -> None:
    run = simulated_run(Drive(seconds=10.0))
    log = Log(runs=(shifted(run, 5.0, "first"), shifted(run, 0.0, "second")))
    drive = prepare_drive(log, "wheel")
    assert [item.run.name for item in drive] == ["first", "second"]
    assert np.all(drive[1].inputs.t < 20.0)


def held_commands() -> Inputs:
    """Commands at 90 Hz for 5 s, new ones every 0.4 s."""
    t = 3.0 + np.arange(450) / 90.0
    kind = (np.arange(450) // 36).astype(float)
    return Inputs(t=t, v=0.4 + 0.3 * np.cos(kind), vy=np.zeros(450), omega=np.sin(2.0 * kind))


def end_of(track: _core.InputTrack) -> np.ndarray:
    """Where a lagging robot whose slip is quadratic in its speed is after 5 s."""
    model = _core.MotionModel(_core.named_basis("odd-even-10"), True, False)
    parameters = np.full(model.size, 0.05)
    parameters[-4:] = np.log((0.25, 0.15, 0.07, 0.11))
    segment = _core.Segment(3.0, 8.0, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    return _core.integrate_segment(model, parameters, track, segment, _core.Integrator.Exact).poses[-1]


def test_inputs_that_repeat_what_is_held_are_left_out_and_move_no_path_by_a_millimetre() -> None:
    inputs = held_commands()
    kept = without_repeats(inputs)
    held = np.searchsorted(kept.t, inputs.t, side="right") - 1
    for name in ("v", "vy", "omega"):
        np.testing.assert_array_equal(getattr(kept, name)[held], getattr(inputs, name))
    assert len(kept) == 13 * 4 - 2  # four of each 0.4 s; the last are cut short
    assert np.max(np.diff(kept.t)) < STEP + 1.0 / 90.0 + 1e-9
    whole = _core.InputTrack(inputs.t, inputs.v, inputs.vy, inputs.omega)
    assert np.linalg.norm(end_of(input_track(inputs, rolling=False)) - end_of(whole)) < 1e-3


def test_wheels_may_roll_before_their_first_sample() -> None:
    inputs = held_commands()
    assert input_track(inputs, rolling=True).at(inputs.t[0] - 0.5).v == inputs.v[0]
    assert input_track(inputs, rolling=False).at(inputs.t[0] - 0.5).v == 0.0
