# SPDX-License-Identifier: Apache-2.0
"""Visits of floors in turn: their order, what a surface's name means, and DART's rows as a log."""

from __future__ import annotations

import numpy as np
from surface_sequences import dart_log, in_turn, meant_by, place


def test_floors_are_visited_in_turn_as_often_as_the_rarest() -> None:
    drives = {"rubbery": [(), (), ()], "tiles": [(), ()]}
    assert [floor for floor, _ in in_turn(drives)] == ["rubbery", "tiles", "rubbery", "tiles"]


def test_a_name_means_the_floor_of_the_first_visit_that_ended_on_it() -> None:
    assert meant_by(["a", "b", "b"], ["one", "one", "two"]) == {"one": "a", "two": "b"}


def test_windows_are_ordered_by_run_before_time() -> None:
    order = place(np.array([0, 0, 1]), np.array([1.0, 90.0, 0.5]))
    assert (np.diff(order) > 0.0).all()


def test_poses_are_the_rows_that_are_new_and_stamps_that_stand_still_are_left_out() -> None:
    rows = np.zeros((4, 7))
    rows[:, 0] = (0.0, 0.01, 0.01, 0.02)
    rows[:, 1] = (1.0, 2.0, 9.0, 3.0)
    rows[:, 6] = (1.0, 0.0, 1.0, 1.0)
    (run,) = dart_log("run", rows).runs
    assert run.wheels is not None
    assert run.wheels.v.tolist() == [1.0, 2.0, 3.0]
    assert run.poses.t.tolist() == [0.0, 0.02]
