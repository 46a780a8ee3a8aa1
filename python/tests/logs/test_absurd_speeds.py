# SPDX-License-Identifier: Apache-2.0
"""Tests of which speeds are absurd: lone spikes that no robot drives, judged by what came before."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.streams import FASTEST, NOMINAL, RawStream, absurd_speeds, to_inputs, to_poses

USUAL_DRIVE = np.array([0.0, 0.5, 1.0, 1.5, 1.5, 1.0, 0.5, 0.0])


def test_a_lone_absurd_cell_is_found_wherever_it_stands(subtests: pytest.Subtests) -> None:
    for spike in [25.0, -90.0, 1e3, 1e6, -1e15, 9.2e18, 1e29]:
        for place in range(len(USUAL_DRIVE)):
            with subtests.test(spike=spike, place=place):
                values = USUAL_DRIVE.copy()
                values[place] = spike
                assert np.flatnonzero(absurd_speeds(values)).tolist() == [place]


@pytest.mark.parametrize("spike", [5.0, -9.0, 19.9])
def test_a_spike_of_a_few_times_what_is_usual_stays(spike: float) -> None:
    assert not absurd_speeds(np.array([1.0, 1.5, spike, 1.5])).any()


def test_a_spike_within_fifteen_times_the_fastest_before_it_stays() -> None:
    assert not absurd_speeds(np.array([0.0, 15.0, 140.0, 12.0])).any()


def test_a_spike_of_wheels_goes_by_what_the_stream_holds(subtests: pytest.Subtests) -> None:
    for spike in [6.0, -12.5, 18.5, 31.0, 1e3]:
        for place in range(1, len(USUAL_DRIVE)):
            with subtests.test(spike=spike, place=place):
                values = 0.2 * USUAL_DRIVE
                values[place] = spike
                assert np.flatnonzero(absurd_speeds(values, measured=True)).tolist() == [place]


def test_wheels_that_turn_when_the_log_begins_lose_nothing_and_their_first_sample_proves_nothing() -> None:
    assert not absurd_speeds(np.full(50, 8.0), measured=True).any()
    spikes = absurd_speeds(np.array([18.0, 0.3, 18.0, 0.3, 18.0]), measured=True)
    assert spikes.tolist() == [False, False, True, False, True]


def test_a_log_that_starts_at_full_speed_loses_one_sample() -> None:
    assert absurd_speeds(np.full(50, 80.0)).tolist() == [True, *[False] * 49]


def test_a_yaw_rate_in_degrees_per_second_is_not_thinned_out() -> None:
    t = np.arange(0.0, 60.0, 0.05)
    assert not absurd_speeds(300.0 * np.sin(t)).any()


def test_what_is_faster_than_any_robot_is_absurd_however_often_it_comes() -> None:
    assert absurd_speeds(np.array([1.0, 1e6, 1e6, 1e6, 1.0])).tolist() == [False, True, True, True, False]


@given(st.lists(st.floats(-1e4, 1e4), max_size=30), st.integers(0, 30), st.booleans())
def test_no_sample_is_judged_by_a_later_one(values: list[float], cut: int, measured: bool) -> None:
    whole = absurd_speeds(np.array(values, dtype=float), measured=measured)
    part = absurd_speeds(np.array(values[:cut], dtype=float), measured=measured)
    assert part.tolist() == whole[:cut].tolist()


@given(st.lists(st.floats(-NOMINAL, NOMINAL)))
def test_nothing_that_robots_drive_is_absurd(values: list[float]) -> None:
    assert not absurd_speeds(np.array(values, dtype=float)).any()


def stream(v: np.ndarray) -> RawStream:
    count = len(v)
    columns = {"v": v, "omega": np.zeros(count)}
    return RawStream("wheels", np.arange(count) * 0.05, columns, np.arange(count), lambda row: f"line {row}")


def test_an_absurd_cell_leaves_its_sample_out_and_is_counted() -> None:
    v = np.full(100, 1.0)
    v[40] = 1e6
    tally = Tally()
    inputs = to_inputs(stream(v), tally)
    assert inputs is not None
    assert np.array_equal(inputs.t, np.delete(np.arange(100) * 0.05, 40))
    (entry,) = tally.result()
    assert (entry.kind, entry.count, entry.where) == ("absurd-speed", 1, "line 40")
    assert entry.reason == "wheels far beyond all speeds before, all at once"


def test_a_stream_in_other_units_is_refused_with_what_to_do() -> None:
    with pytest.raises(LogError, match=f"wheels are faster than {FASTEST:g} m/s") as caught:
        to_inputs(stream(np.full(100, 1500.0)), Tally())
    assert caught.value.advice == "convert speeds to m/s and yaw rates to rad/s"


def test_a_tilt_of_more_than_a_turn_is_not_known() -> None:
    zero = np.zeros(4)
    columns = {"x": zero, "y": zero, "yaw": zero, "roll": np.array([0.1, 1e6, 0.1, 0.1]), "pitch": zero}
    poses = to_poses(RawStream("poses", np.arange(4.0), columns, np.arange(4), str), Tally())
    assert poses.roll is not None
    assert np.isnan(poses.roll).tolist() == [False, True, False, False]
