# SPDX-License-Identifier: Apache-2.0
"""Windows become rows: bins hold mean inputs, headings go beyond half a turn, chords and poses are one."""

from dataclasses import replace
from functools import cache

import numpy as np
from sample_logs import Drive, simulated_log
from window_inputs import (
    BINS,
    BINS_BEFORE,
    beside,
    chords,
    poses_of,
    unwrapped_motion,
    window_inputs,
)

from slipwise.calibration import make_settings
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.logs import Inputs, Poses


@cache
def windows() -> WindowSet:
    drive = prepare_run(simulated_log(Drive(seconds=30.0, lag=0.3)), "command")
    return collect_windows(drive, 2.0, make_settings({}).rules())


def spinning() -> WindowSet:
    """The same, but for a robot that turns at 2.5 rad/s."""
    run = windows().drive[0]
    t = run.run.poses.t
    yaw = np.angle(np.exp(2.5j * t))
    poses = Poses(t=t, x=np.zeros(len(t)), y=np.zeros(len(t)), yaw=yaw, frame=np.zeros(len(t), np.int64))
    drive = (replace(run, run=replace(run.run, poses=poses)),)
    return collect_windows(drive, 2.0, make_settings({}).rules())


def test_bins_hold_the_mean_inputs_in_their_time() -> None:
    rows, run = window_inputs(windows()), windows().drive[0]
    assert rows.shape == (len(windows()), 3 * (BINS + BINS_BEFORE + 1))
    k = 5
    fine = np.arange(
        windows().start[k], windows().start[k] + (windows().end[k] - windows().start[k]) / BINS, 1e-4
    )
    held = run.inputs.v[np.searchsorted(run.inputs.t, fine, side="right") - 1]
    np.testing.assert_allclose(rows[k, BINS_BEFORE], held.mean(), atol=2e-3)


def test_the_speeds_at_the_start_are_those_of_the_wheels_not_later_ones() -> None:
    run = windows().drive[0]
    assert run.wheels is not None
    rows = window_inputs(windows())
    for k in (0, 3, len(windows()) - 1):
        last = np.flatnonzero(run.wheels.t <= windows().start[k])[-1]
        assert rows[k, -3] == run.wheels.v[last]
        assert rows[k, -1] == run.wheels.omega[last]


def test_inputs_after_a_window_do_not_reach_its_row() -> None:
    run, k = windows().drive[0], 4
    late = run.inputs.t >= windows().end[k]
    changed = Inputs(t=run.inputs.t, v=run.inputs.v + late, vy=run.inputs.vy, omega=run.inputs.omega - late)
    other = replace(windows(), drive=(replace(run, inputs=changed),))
    assert (window_inputs(other)[: k + 1] == window_inputs(windows())[: k + 1]).all()


def test_a_heading_is_followed_beyond_half_a_turn() -> None:
    moved = unwrapped_motion(spinning())
    np.testing.assert_allclose(moved[:, 2], 2.5 * (spinning().end - spinning().start), atol=1e-9)


def test_chords_and_poses_are_inverse_and_an_arc_has_its_chord_along_x() -> None:
    turn = np.array([-5.0, -1.0, 1e-3, 2.0, 7.0])
    arc = np.column_stack((np.sin(turn) / turn, (1.0 - np.cos(turn)) / turn, turn))
    np.testing.assert_allclose(chords(arc)[:, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(poses_of(chords(arc)), arc, atol=1e-12)


def test_beside_moves_by_whole_turns_alone() -> None:
    moved = beside(np.array([[1.0, 2.0, 0.3]]), np.array([13.0]))
    np.testing.assert_allclose(moved, [[1.0, 2.0, 0.3 + 4.0 * np.pi]])
