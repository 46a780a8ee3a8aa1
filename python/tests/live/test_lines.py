# SPDX-License-Identifier: Apache-2.0
"""Lines of text are samples, or errors that say what is wrong."""

from __future__ import annotations

import contextlib
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from live.sample_outputs import next_moves, surface_at

from slipwise.errors import LogError
from slipwise.live.lines import LineReader, line_of
from slipwise.live.outputs import AppliedParameters, ModelText, Note, Odometry, Path
from slipwise.live.samples import (
    Command,
    KnownForce,
    Override,
    Pose,
    Reading,
    Request,
    RunStart,
    SurfaceCue,
    Unusable,
    Wheels,
)
from slipwise.logs import LogOptions
from slipwise.logs.tidy import UNSAID


def test_a_csv_line_holds_what_its_filled_cells_say() -> None:
    reader = LineReader()
    assert reader.read("t,cmd_v,cmd_omega,odo_v,odo_omega,x,y,yaw,override\n") == []
    assert reader.read("1.5,0.4,0.1,0.38,0.09,1,2,0.3,\n") == [
        Command(1.5, 0.4, 0.1),
        Wheels(1.5, 0.38, 0.09),
        Pose(1.5, 1.0, 2.0, 0.3),
    ]
    assert reader.read("1.6,,,0.38,0.09,,,,1") == [Override(1.6, True), Wheels(1.6, 0.38, 0.09)]
    assert reader.read("") == reader.read("# a comment") == []


def test_a_json_line_needs_no_header_and_may_ask() -> None:
    reader = LineReader()
    assert reader.read('{"t": 2, "odo_v": 0.5, "odo_omega": 0, "x": null}') == [Wheels(2.0, 0.5, 0.0)]
    pose = '{"t": 2, "x": 1, "y": 2, "yaw": 3, "std_xy": 0.1, "frame": "map", "roll": 0.1, "pitch": 0.2}'
    assert reader.read(pose) == [Pose(2.0, 1.0, 2.0, 3.0, 0.1, None, "map", 0.1, 0.2)]
    assert reader.read('{"apply": true}') == [Request("apply")]
    assert reader.read('{"run": "tuesday"}') == [RunStart("tuesday")]
    (asked,) = reader.read('{"predict": {"horizon": 1, "commands": [[0, 1, 0]]}}')
    assert isinstance(asked, Request)
    assert json.loads(asked.content) == {"horizon": 1, "commands": [[0, 1, 0]]}


def test_what_is_no_line_says_why(subtests: pytest.Subtests) -> None:
    for line, said in [
        ("1.0,2.0", "before a header"),
        ('{"t": "noon", "x": 1, "y": 2, "yaw": 3}', "'noon', not a number"),
        ('{"t": 1', "not a JSON object"),
        ('{"odo_v": 1, "odo_omega": 2}', "no t"),
        ("x" * 20_000, "too long"),
    ]:
        with subtests.test(line=line, said=said), pytest.raises(LogError, match=said):
            LineReader().read(line)


def test_a_line_of_another_length_than_its_header_says_so() -> None:
    reader = LineReader()
    reader.read("t,odo_v,odo_omega")
    with pytest.raises(LogError, match="2 cells where the header has 3"):
        reader.read("1.0,2.0")


@given(st.text(max_size=200))
def test_any_text_is_samples_or_an_error(text: str) -> None:
    reader = LineReader()
    reader.read("t,odo_v,odo_omega")
    with contextlib.suppress(LogError):
        assert isinstance(reader.read(text), list)


def test_results_are_json_without_what_json_cannot_say() -> None:
    nan = np.full((3, 3), np.nan)
    odometry = Odometry(1.0, "odom", "base_link", np.zeros(3), nan, np.zeros(3), nan, 0.0)
    path = Path(np.zeros(1), "odom", np.zeros((1, 3)), nan[None])
    outputs = (odometry, path, ModelText(1.0, "x: 1"), Note(float("nan"), "said"))
    contents = [json.loads(line_of(output)) for output in outputs]
    assert contents[0]["covariance"] == [None] * 9
    assert contents[1]["predicted_path"] == [[0.0, 0.0, 0.0]]
    assert contents[2] == {"model": "x: 1", "t": 1.0}
    assert contents[3] == {"note": "said", "t": None}
    told = json.loads(line_of(AppliedParameters(1.0, "mppi", "/controller_server", {"vx_max": 0.4})))
    assert told["set"] == {"vx_max": 0.4}


def test_a_line_may_name_the_ground_or_say_that_it_changes() -> None:
    reader = LineReader()
    assert reader.read('{"terrain": "sand"}') == [SurfaceCue("sand")]
    assert reader.read('{"terrain_changed": true}') == [SurfaceCue()]
    reader.read("t,odo_v,odo_omega,terrain")
    assert reader.read("1.0,0.5,0.1,sand") == [SurfaceCue("sand"), Wheels(1.0, 0.5, 0.1)]
    assert reader.read("1.1,0.5,0.1,") == [Wheels(1.1, 0.5, 0.1)]


def test_moves_worth_driving_are_a_line() -> None:
    content = json.loads(line_of(next_moves(t=float("nan"))))
    assert content["t"] is None
    assert [move["teaches"] for move in content["next_moves"]["moves"]] == [
        "ang.V*w",
        "lon.V",
        "time_constant_omega",
    ]


def test_the_surface_is_a_line_with_its_probability() -> None:
    content = json.loads(line_of(surface_at()))
    assert (content["surface"], content["probability"], content["t"]) == ("sand", 0.9, 3.0)


def test_a_column_that_is_none_of_a_tidy_log_is_named_once_and_counted() -> None:
    reader = LineReader()
    reader.read("t,odo_v,odo_omega,battery")
    first, *wheels = reader.read("1.0,0.5,0.1,12.1")
    assert isinstance(first, Unusable)
    assert first.text == "column 'battery' is none of a tidy log and is not used"
    assert wheels == [Wheels(1.0, 0.5, 0.1)]
    assert reader.read("1.1,0.5,0.1,12.0") == [Wheels(1.1, 0.5, 0.1)]


def test_what_is_half_there_is_counted_and_the_rest_of_the_line_is_used() -> None:
    reader = LineReader()
    reader.read("t,odo_v,odo_omega,x,y,yaw,gyro_z,force_y")
    half, force, gyro = reader.read("1.0,0.5,,1,2,nan,0.2,0.7")[-3:]
    assert isinstance(half, Unusable)
    assert (force, gyro) == (KnownForce(1.0, 0.0, 0.7), Reading(1.0, "gyro_z", 0.2))
    said = [each.reason for each in reader.read("1.1,0.5,,1.5,2,nan,,") if isinstance(each, Unusable)]
    assert "wheels with a number missing or impossible" in said
    assert "poses with a number missing or impossible" in said


@pytest.mark.parametrize(
    ("line", "words"),
    [('{"t": 1, "x": 1}', "x is used"), ('{"t": 1, "x": 1, "yaw": 0}', "x, yaw are used")],
)
def test_a_pose_without_both_coordinates_is_said(line: str, words: str) -> None:
    reader = LineReader()
    reader.read(line)
    assert reader.notes == [f"lines: {words} where both x and y are there"]


def test_a_pose_that_is_repeated_is_held_unless_it_is_said_to_be_new() -> None:
    reader = LineReader()
    line = '{"t": %s, "x": 1, "y": 2, "yaw": 3%s}'
    assert reader.read(line % (1, "")) == [Pose(1.0, 1.0, 2.0, 3.0)]
    (held,) = reader.read(line % (2, ""))
    assert isinstance(held, Unusable)
    assert reader.read(line % (3, ', "pose_new": 1')) == [Pose(3.0, 1.0, 2.0, 3.0)]


def test_each_source_holds_its_own_poses() -> None:
    reader, line = LineReader(), '{"t": %s, "x": 1, "y": 2, "yaw": 3, "source": "%s"}'
    read = [reader.read(line % (t, source))[0] for t, source in ((1, "a"), (2, "b"), (3, "a"), (4, "b"))]
    assert [isinstance(each, Unusable) for each in read] == [False, False, True, True]


def test_a_pose_of_which_nobody_says_whether_it_is_new_is_counted() -> None:
    (said,) = LineReader().read('{"t": 1, "x": 1, "y": 2, "yaw": 3, "pose_new": 2}')
    assert isinstance(said, Unusable)
    assert UNSAID in said.reason


def test_lines_without_names_have_columns_by_number() -> None:
    reader = LineReader(LogOptions(columns={"t": "0", "odo_v": "2", "odo_omega": "1"}))
    assert reader.read("1.5,0.1,0.5") == [Wheels(1.5, 0.5, 0.1)]
