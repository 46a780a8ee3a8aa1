# SPDX-License-Identifier: Apache-2.0
"""Raw samples become clean inputs and poses, and all that is left out is counted with its place."""

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.streams import RawStream, clean_stream, order_codes, to_inputs, to_poses


def stream(name: str, t: list[float], optional: tuple[str, ...] = (), **columns: list[float]) -> RawStream:
    arrays = {key: np.array(values, float) for key, values in columns.items()}
    rows = np.arange(len(t)) + 2
    return RawStream(name, np.array(t, float), arrays, rows, lambda row: f"line {row}", frozenset(optional))


def test_samples_that_are_wrong_are_left_out_and_counted_where_they_begin() -> None:
    raw = stream(
        "commands",
        t=[0.0, 1.0, 1.0, 2.0, 1.5, 3.0, np.nan],
        v=[1.0, 1.0, 1.0, np.nan, 1.0, 1.0, 1.0],
        omega=[0.0] * 7,
    )
    tally = Tally()
    clean = clean_stream(raw, tally)
    assert clean.t.tolist() == [0.0, 1.0, 1.5, 3.0]
    found = {entry.kind: (entry.count, entry.where) for entry in tally.result()}
    assert found == {"incomplete": (2, "line 5"), "duplicate-stamp": (1, "line 4")}


def test_a_column_that_need_not_be_there_may_hold_no_number() -> None:
    raw = stream("poses", t=[0.0, 1.0], optional=("z",), x=[0.0, 1.0], z=[np.nan, 2.0])
    assert len(clean_stream(raw, Tally()).t) == 2


def test_stamps_in_another_unit_are_an_error_with_advice() -> None:
    raw = stream("commands", t=[1.7e18, 1.7e18 + 1e8], v=[1.0, 1.0], omega=[0.0, 0.0])
    with pytest.raises(LogError, match="stamps of commands are about"):
        clean_stream(raw, Tally())


def test_one_absurd_speed_is_left_out_and_many_are_an_error() -> None:
    t = np.arange(100.0).tolist()
    v = [0.5] * 100
    v[40] = 1e6
    tally = Tally()
    inputs = to_inputs(stream("commands", t=t, v=v, omega=[0.0] * 100), tally)
    assert inputs is not None
    assert len(inputs.t) == 99
    assert inputs.vy.tolist() == [0.0] * 99
    assert [(entry.kind, entry.where) for entry in tally.result()] == [("absurd-speed", "line 42")]
    with pytest.raises(LogError, match="100 of 100 commands are faster"):
        to_inputs(stream("commands", t=t, v=[1e6] * 100, omega=[0.0] * 100), Tally())


def test_nothing_left_is_no_input() -> None:
    raw = stream("commands", t=[0.0, 1.0], v=[np.nan, np.nan], omega=[0.0, 0.0])
    assert to_inputs(raw, Tally()) is None


def test_deviations_of_zero_are_unknown_and_columns_without_a_number_are_none() -> None:
    poses = to_poses(
        stream(
            "poses",
            t=[0.0, 1.0],
            optional=("std_xy", "std_yaw", "roll"),
            x=[0.0, 1.0],
            y=[0.0, 0.0],
            yaw=[0.0, 0.1],
            std_xy=[0.0, 0.02],
            std_yaw=[0.0, -1.0],
            roll=[0.1, 100.0],
        ),
        Tally(),
    )
    assert poses.std_xy is not None
    assert np.isnan(poses.std_xy).tolist() == [True, False]
    assert poses.std_yaw is None
    assert poses.roll is not None
    assert np.isnan(poses.roll).tolist() == [False, True]
    assert poses.frame.tolist() == [0, 0]


def test_codes_count_up_in_the_order_of_their_first_place() -> None:
    assert order_codes(np.array([7, 3, 7, 9, 3])).tolist() == [0, 1, 0, 2, 1]
    assert order_codes(np.array([], np.int64)).tolist() == []
