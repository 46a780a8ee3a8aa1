# SPDX-License-Identifier: Apache-2.0
"""MCAP files with protobuf and JSON in place of ROS messages are read like bags."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sample_foxglove import (
    COUNT,
    PERIOD,
    START,
    STILL,
    TURN,
    TWIST,
    WRITERS,
    Writer,
    place,
    pose_of,
    stamp,
    write_ros_json,
    writer_module,
)

from slipwise.errors import LogError
from slipwise.logs import Log, LogOptions, open_log, unpacking
from slipwise.logs.foxglove_file import has_other_schemas
from slipwise.logs.survey import survey_log

pytest.importorskip("mcap_protobuf")


@pytest.fixture(params=WRITERS)
def file(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return WRITERS[request.param](tmp_path / "drive.mcap")


def check(log: Log, *, count: int = COUNT) -> None:
    (run,) = log.runs
    assert run.commands is not None
    assert len(run.poses) == len(run.commands) == count
    expected = np.array([place(k) for k in range(count)])
    np.testing.assert_allclose(run.poses.x, expected[:, 0], atol=1e-9)
    np.testing.assert_allclose(run.poses.y, expected[:, 1], atol=1e-9)
    np.testing.assert_allclose(np.unwrap(run.poses.yaw), expected[:, 2], atol=1e-9)
    np.testing.assert_allclose(run.poses.t - START / 1e9, np.arange(count) * PERIOD / 1e9, atol=1e-6)
    assert set(run.commands.omega) == {TURN}


def test_poses_and_commands_are_read(file: Path) -> None:
    log = open_log(file)
    check(log)
    assert log.left_out == ()
    assert log.sources[0].format == "mcap"


def test_inspect_names_the_types_that_they_stand_for(file: Path) -> None:
    parts = {part.name: part for part in survey_log(file, LogOptions()).parts}
    assert parts["/cmd_vel"].used_as == "command"
    assert {part.used_as for part in parts.values()} == {"command", "pose"}
    assert parts["/cmd_vel"].count == COUNT
    assert parts["/cmd_vel"].rate == pytest.approx(20.0, rel=0.01)


def test_a_bag_of_ros_is_not_taken_for_one_of_these(tmp_path: Path) -> None:
    made = Writer()
    channel = made.channel("/a", "std_msgs/msg/String", kind="cdr", definition=b"string data\n")
    made.add(channel, 0, b"\x00\x01\x00\x00\x03\x00\x00\x00hi\x00")
    assert not has_other_schemas(made.write(tmp_path / "ros.mcap"))
    (tmp_path / "a.csv").write_text("t,x\n")
    assert not has_other_schemas(tmp_path / "a.csv")


@pytest.mark.parametrize("compression", writer_module.CompressionType)
def test_a_file_that_is_cut_off_is_read_as_far_as_it_is_whole(tmp_path: Path, compression: Any) -> None:
    made = Writer(chunk_size=4000, compression=compression)
    poses, commands = made.channel("/pose", "foxglove.PoseInFrame"), made.channel("/cmd", TWIST)
    for k in range(COUNT):
        time = {"timestamp": stamp(k, ("sec", "nsec"))}
        made.add(poses, k, time | {"frame_id": "map", "pose": pose_of(k)})
        made.add(commands, k, STILL)
    path = made.write(tmp_path / "drive.mcap")
    path.write_bytes(path.read_bytes()[: len(path.read_bytes()) // 2])
    assert has_other_schemas(path)
    log = open_log(path)
    assert 50 < len(log.runs[0].poses) < 350
    assert any(entry.kind == "damaged-bag" for entry in log.left_out)


def test_a_message_that_lacks_a_field_is_left_out_and_counted(tmp_path: Path) -> None:
    made = Writer()
    poses, commands = made.channel("/pose", "foxglove.PoseInFrame"), made.channel("/cmd", TWIST)
    for k in range(20):
        made.add(commands, k, STILL)
        content = {"timestamp": stamp(k, ("sec", "nsec")), "frame_id": "map", "pose": pose_of(k)}
        made.add(poses, k, {"frame_id": "map"} if k == 3 else b"[1]" if k == 4 else content)
    log = open_log(made.write(tmp_path / "drive.mcap"))
    assert len(log.runs[0].poses) == 18
    (entry,) = log.left_out
    assert (entry.kind, entry.count) == ("bad-message", 2)
    assert "/pose that cannot be decoded as foxglove.PoseInFrame" in entry.reason


def test_a_message_that_holds_something_else_than_numbers_is_left_out_whole(
    tmp_path: Path, subtests: pytest.Subtests
) -> None:
    for wrong in [
        {"orientation": {"x": 0.0, "y": 0.0, "z": 0.0}},
        {"position": {"x": "far", "y": 0.0, "z": 0.0}},
        {"position": {"x": None, "y": 0.0, "z": 0.0}},
        {"position": {"x": 10**400, "y": 0.0, "z": 0.0}},
        {"position": [1.0, 2.0, 3.0]},
    ]:
        with subtests.test(wrong=wrong):
            made = Writer()
            poses, commands = made.channel("/pose", "foxglove.PoseInFrame"), made.channel("/cmd", TWIST)
            for k in range(20):
                made.add(commands, k, STILL)
                pose = pose_of(k) | (wrong if k == 3 else {})
                made.add(poses, k, {"timestamp": stamp(k, ("sec", "nsec")), "frame_id": "map", "pose": pose})
            log = open_log(made.write(tmp_path / "drive.mcap"))
            assert len(log.runs[0].poses) == 19
            (entry,) = log.left_out
            assert (entry.kind, entry.count) == ("bad-message", 1)


def test_transforms_whose_frames_have_no_names_are_left_out(tmp_path: Path) -> None:
    path = WRITERS["transforms"](tmp_path / "drive.mcap")
    whole = open_log(path)
    made = Writer()
    poses, commands = made.channel("/tf", "foxglove.FrameTransforms"), made.channel("/cmd", TWIST)
    for k in range(COUNT):
        made.add(commands, k, STILL)
        pose, frame = pose_of(k), 7 if k == 5 else "map"
        moved = {"translation": pose["position"], "rotation": pose["orientation"]}
        names = {"parent_frame_id": frame, "child_frame_id": "base_link"}
        made.add(poses, k, {"transforms": [{"timestamp": stamp(k, ("sec", "nsec"))} | names | moved]})
    log = open_log(made.write(tmp_path / "other.mcap"))
    assert len(log.runs[0].poses) == len(whole.runs[0].poses) - 1
    assert [entry.kind for entry in log.left_out] == ["bad-message"]


@pytest.mark.filterwarnings("error")
def test_a_transform_that_is_no_number_is_a_pose_left_out(tmp_path: Path) -> None:
    made = Writer()
    poses, commands = made.channel("/tf", "foxglove.FrameTransforms"), made.channel("/cmd", TWIST)
    for k in range(COUNT):
        made.add(commands, k, STILL)
        pose = pose_of(k)
        moved = {"translation": pose["position"], "rotation": pose["orientation"]}
        if k == 5:
            moved = {
                "translation": {"x": 1e999, "y": float("nan"), "z": 0.0},
                "rotation": pose["orientation"],
            }
        names = {"parent_frame_id": "map", "child_frame_id": "base_link"}
        made.add(poses, k, {"transforms": [{"timestamp": stamp(k, ("sec", "nsec"))} | names | moved]})
    log = open_log(made.write(tmp_path / "drive.mcap"))
    assert 0.25 not in (log.runs[0].poses.t - START / 1e9).round(6).tolist()
    assert np.isfinite(log.runs[0].poses.x).all()
    assert len(log.runs[0].poses) == COUNT - 2  # and the one after it, between which and it lies its stamp
    assert sum(entry.count for entry in log.left_out) == 2


def test_what_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpacking, "MOST_UNPACKED", 1.0)
    made = Writer(chunk_size=1 << 22, compression=writer_module.CompressionType.ZSTD)
    poses = made.channel("/pose", "foxglove.PoseInFrame")
    made.add(poses, 0, b'{"x": "' + b" " * (1 << 21) + b'"}')
    path = made.write(tmp_path / "drive.mcap")
    with pytest.raises(LogError, match="unpacks to more than 1 MiB"):
        open_log(path)


def test_without_the_library_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_ros_json(tmp_path / "drive.mcap")
    monkeypatch.setitem(sys.modules, "mcap_protobuf.decoder", None)
    with pytest.raises(LogError, match=r"is not installed .*pip install 'mcap-protobuf-support"):
        open_log(path)
