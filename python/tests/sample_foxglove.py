# SPDX-License-Identifier: Apache-2.0
"""A drive in a circle as MCAP files with JSON or protobuf, written by the libraries of these formats."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

writer_module = pytest.importorskip("mcap.writer")

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


def write_ros_json(path: Path, count: int = COUNT) -> Path:
    """Odometry and twists as JSON under the names of ROS."""
    made = Writer()
    poses = made.channel("/rtk/odom", "nav_msgs/msg/Odometry")
    commands = made.channel("/cmd_vel", "geometry_msgs/Twist")
    for k in range(count):
        header = {"stamp": stamp(k, ("sec", "nanosec")), "frame_id": "map"}
        pose = {"pose": pose_of(k), "covariance": [0.01] * 36}
        made.add(poses, k, {"header": header, "child_frame_id": "base_link", "pose": pose, "twist": {}})
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        made.add(commands, k, {"linear": zero | {"x": 1.0}, "angular": zero | {"z": TURN}})
    return made.write(path)


def write_foxglove_json(path: Path, count: int = COUNT, *, transforms: bool = False) -> Path:
    """Poses in Foxglove's schema, or transforms, and twists of ROS."""
    made = Writer()
    poses = made.channel(
        "/tf" if transforms else "/pose", f"foxglove.{'FrameTransforms' if transforms else 'PoseInFrame'}"
    )
    commands = made.channel("/cmd_vel", "geometry_msgs/TwistStamped")
    for k in range(count):
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


def write_protobuf(path: Path, count: int = COUNT) -> Path:
    """Poses as protobuf by Foxglove's own library, beside twists in JSON."""
    foxglove = pytest.importorskip("foxglove")
    from foxglove import messages
    from foxglove.channels import PoseInFrameChannel

    context = foxglove.Context()
    with foxglove.open_mcap(str(path), context=context):
        poses = PoseInFrameChannel("/pose", context=context)
        schema = foxglove.Schema(name="geometry_msgs/Twist", encoding="jsonschema", data=ANY)
        commands = foxglove.Channel("/cmd_vel", schema=schema, message_encoding="json", context=context)
        for k in range(count):
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


def write_transforms(path: Path, count: int = COUNT) -> Path:
    return write_foxglove_json(path, count, transforms=True)


WRITERS: dict[str, Callable[[Path], Path]] = {
    "ros-json": write_ros_json,
    "foxglove-json": write_foxglove_json,
    "transforms": write_transforms,
    "protobuf": write_protobuf,
}
