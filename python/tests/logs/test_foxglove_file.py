# SPDX-License-Identifier: Apache-2.0
"""MCAP files with protobuf and JSON in place of ROS messages are read like bags."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs import Log, LogOptions, open_log
from slipwise.logs.foxglove_file import has_other_schemas
from slipwise.logs.survey import survey_log

writer_module = pytest.importorskip("mcap.writer")
pytest.importorskip("mcap_protobuf")

START, PERIOD, COUNT = 1_700_000_000_000_000_000, 50_000_000, 400  # ns, ns, messages
TURN = 0.3  # rad/s, to the left, at 1 m/s
TWIST = "geometry_msgs/Twist"
STILL = {name: {"x": 0.0, "y": 0.0, "z": 0.0} for name in ("linear", "angular")}
ANY = json.dumps({"type": "object"}).encode()


def place(k: int) -> tuple[float, float, float]:
    yaw = TURN * k * PERIOD / 1e9
    return float(np.sin(yaw) / TURN), float((1.0 - np.cos(yaw)) / TURN), float(yaw)


def pose_of(k: int) -> dict[str, Any]:
    x, y, yaw = place(k)
    orientation = {"x": 0.0, "y": 0.0, "z": float(np.sin(yaw / 2)), "w": float(np.cos(yaw / 2))}
    return {"position": {"x": x, "y": y, "z": 0.0}, "orientation": orientation}


def stamp(k: int, names: tuple[str, str]) -> dict[str, int]:
    return dict(zip(names, divmod(START + k * PERIOD, 1_000_000_000), strict=True))


class Writer:
    """Writes an MCAP file with the library of the format."""

    def __init__(self, **options: Any) -> None:
        self.file = io.BytesIO()
        self.mcap = writer_module.Writer(self.file, **options)
        self.mcap.start()

    def channel(self, topic: str, schema: str, *, kind: str = "json", definition: bytes = ANY) -> int:
        encoding = "jsonschema" if kind == "json" else kind
        number = self.mcap.register_schema(schema, encoding, definition)
        return int(self.mcap.register_channel(topic, kind, number))

    def add(self, channel: int, k: int, content: dict[str, Any] | bytes) -> None:
        data = content if isinstance(content, bytes) else json.dumps(content).encode()
        self.mcap.add_message(channel, START + k * PERIOD, data, START + k * PERIOD)

    def write(self, path: Path) -> Path:
        self.mcap.finish()
        path.write_bytes(self.file.getvalue())
        return path


def write_ros_json(path: Path) -> Path:
    """Odometry and twists as JSON under the names of ROS."""
    made = Writer()
    poses = made.channel("/rtk/odom", "nav_msgs/msg/Odometry")
    commands = made.channel("/cmd_vel", "geometry_msgs/Twist")
    for k in range(COUNT):
        header = {"stamp": stamp(k, ("sec", "nanosec")), "frame_id": "map"}
        pose = {"pose": pose_of(k), "covariance": [0.01] * 36}
        made.add(poses, k, {"header": header, "child_frame_id": "base_link", "pose": pose, "twist": {}})
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        made.add(commands, k, {"linear": zero | {"x": 1.0}, "angular": zero | {"z": TURN}})
    return made.write(path)


def write_foxglove_json(path: Path, *, transforms: bool = False) -> Path:
    """Poses in Foxglove's schema, or transforms, and twists of ROS."""
    made = Writer()
    poses = made.channel(
        "/tf" if transforms else "/pose", f"foxglove.{'FrameTransforms' if transforms else 'PoseInFrame'}"
    )
    commands = made.channel("/cmd_vel", "geometry_msgs/TwistStamped")
    for k in range(COUNT):
        pose = pose_of(k)
        time = {"timestamp": stamp(k, ("sec", "nsec"))}
        if transforms:
            names = {"parent_frame_id": "map", "child_frame_id": "base_link"}
            moved = {"translation": pose["position"], "rotation": pose["orientation"]}
            made.add(poses, k, {"transforms": [time | names | moved]})
        else:
            made.add(poses, k, time | {"frame_id": "map", "pose": pose})
        twist = {"linear": {"x": 1.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": TURN}}
        header = {"stamp": stamp(k, ("sec", "nanosec")), "frame_id": ""}
        made.add(commands, k, {"header": header, "twist": twist})
    return made.write(path)


def write_protobuf(path: Path) -> Path:
    """Poses as protobuf by Foxglove's own library, beside twists in JSON."""
    foxglove = pytest.importorskip("foxglove")
    from foxglove import messages
    from foxglove.channels import PoseInFrameChannel

    context = foxglove.Context()
    with foxglove.open_mcap(str(path), context=context):
        poses = PoseInFrameChannel("/pose", context=context)
        schema = foxglove.Schema(name="geometry_msgs/Twist", encoding="jsonschema", data=ANY)
        commands = foxglove.Channel("/cmd_vel", schema=schema, message_encoding="json", context=context)
        for k in range(COUNT):
            nanoseconds, pose = START + k * PERIOD, pose_of(k)
            made = messages.Pose(
                position=messages.Vector3(**pose["position"]),
                orientation=messages.Quaternion(**pose["orientation"]),
            )
            time = messages.Timestamp(*divmod(nanoseconds, 1_000_000_000))
            poses.log(messages.PoseInFrame(timestamp=time, frame_id="map", pose=made), log_time=nanoseconds)
            twist = {"linear": {"x": 1.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": TURN}}
            commands.log(json.dumps(twist).encode(), log_time=nanoseconds)
    return path


def write_transforms(path: Path) -> Path:
    return write_foxglove_json(path, transforms=True)


WRITERS: dict[str, Callable[[Path], Path]] = {
    "ros-json": write_ros_json,
    "foxglove-json": write_foxglove_json,
    "transforms": write_transforms,
    "protobuf": write_protobuf,
}


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


def test_damaged_bytes_never_end_otherwise_than_in_a_log_or_a_log_error(file: Path) -> None:
    data, rng = file.read_bytes(), np.random.default_rng(0)
    for _ in range(15):
        damaged = bytearray(data)
        for at in rng.integers(8, len(damaged), 20):
            damaged[at] = rng.integers(256)
        file.write_bytes(damaged)
        with contextlib.suppress(LogError):
            assert len(open_log(file).runs) == 1


def test_what_unpacks_to_too_much_is_refused(tmp_path: Path) -> None:
    made = Writer(chunk_size=1 << 22, compression=writer_module.CompressionType.ZSTD)
    poses = made.channel("/pose", "foxglove.PoseInFrame")
    made.add(poses, 0, b'{"x": "' + b" " * (1 << 21) + b'"}')
    path = made.write(tmp_path / "drive.mcap")
    with pytest.raises(LogError, match="unpacks to more than 1 MiB"):
        open_log(path, options=LogOptions(most_unpacked=1.0))


def test_without_the_library_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_ros_json(tmp_path / "drive.mcap")
    monkeypatch.setitem(sys.modules, "mcap_protobuf.decoder", None)
    with pytest.raises(LogError, match=r"is not installed .*pip install 'slipwise\[foxglove\]'"):
        open_log(path)
