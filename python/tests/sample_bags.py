# SPDX-License-Identifier: Apache-2.0
"""Small ROS bags for tests, written message by message in any format."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from slipwise.logs.messages import ACKERMANN, ACKERMANN_DEFINITION, TF, TF_DEFINITION

POSE = "geometry_msgs/msg/PoseStamped"
TWIST = "geometry_msgs/msg/Twist"
ODOMETRY = "nav_msgs/msg/Odometry"
JOINT_STATE = "sensor_msgs/msg/JointState"
SECOND = 1_000_000_000
EPOCH = 1_700_000_000 * SECOND


@dataclass
class Bag:
    """Collects messages and writes them in any format."""

    ros1: bool = False
    messages: list[tuple[int, str, str, Any]] = field(default_factory=list)
    silent: dict[str, str] = field(default_factory=dict)  # types of topics without a message

    def __post_init__(self) -> None:
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg(ACKERMANN_DEFINITION, ACKERMANN))
        if self.ros1:
            self.store.register(get_types_from_msg(TF_DEFINITION, TF))

    def make(self, kind: str, *values: Any) -> Any:
        return self.store.types[kind](*values)

    def header(self, stamp: int, frame: str = "map") -> Any:
        time = self.make("builtin_interfaces/msg/Time", stamp // SECOND, stamp % SECOND)
        return self.make("std_msgs/msg/Header", *([0] if self.ros1 else []), time, frame)

    def vector(self, x: float, y: float, z: float) -> Any:
        return self.make("geometry_msgs/msg/Vector3", x, y, z)

    def twist(self, v: float, omega: float) -> Any:
        return self.make(TWIST, self.vector(v, 0.0, 0.0), self.vector(0.0, 0.0, omega))

    def pose(self, x: float, y: float, yaw: float) -> Any:
        return self.make(
            "geometry_msgs/msg/Pose",
            self.make("geometry_msgs/msg/Point", x, y, 0.0),
            self.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)),
        )

    def odometry(self, stamp: int, x: float, y: float, yaw: float, v: float = 0.0, omega: float = 0.0) -> Any:
        covariance = np.zeros(36)
        pose = self.make("geometry_msgs/msg/PoseWithCovariance", self.pose(x, y, yaw), covariance)
        twist = self.make("geometry_msgs/msg/TwistWithCovariance", self.twist(v, omega), covariance)
        return self.make(ODOMETRY, self.header(stamp, "odom"), "base_link", pose, twist)

    def transform(self, stamp: int, parent: str, child: str, motion: tuple[float, float, float]) -> Any:
        """Return a TFMessage with one transform (x, y, yaw)."""
        x, y, yaw = motion
        turn = self.pose(x, y, yaw).orientation
        transform = self.make("geometry_msgs/msg/Transform", self.vector(x, y, 0.0), turn)
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped", self.header(stamp, parent), child, transform
        )
        return self.make(TF, [stamped])

    def joints(self, stamp: int, names: list[str], positions: list[float], speeds: list[float]) -> Any:
        effort = np.zeros(0)
        return self.make(
            JOINT_STATE, self.header(stamp), names, np.array(positions), np.array(speeds), effort
        )

    def add(self, stamp: int, topic: str, kind: str, message: Any) -> None:
        self.messages.append((stamp, topic, kind, message))

    def write(self, path: Path) -> Path:
        if self.ros1:
            self._fill(Writer1(path), self.store.serialize_ros1)
            return path
        plugin = StoragePlugin.SQLITE3 if path.suffix == ".db3" else StoragePlugin.MCAP
        folder = path.with_suffix("")
        self._fill(Writer2(folder, version=9, storage_plugin=plugin), self.store.serialize_cdr)
        return folder

    def _fill(self, writer: Any, serialise: Callable[[Any, str], Any]) -> None:
        with writer:
            connections: dict[str, Any] = {
                topic: writer.add_connection(topic, kind, typestore=self.store)
                for topic, kind in self.silent.items()
            }
            for stamp, topic, kind, message in self.messages:
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=self.store)
                writer.write(connections[topic], stamp, bytes(serialise(message, kind)))


def drive_along_x(bag: Bag, *, count: int = 100, start: int = EPOCH) -> Bag:
    """Drive at 1 m/s along x: commands and poses at 10 Hz."""
    for k in range(count):
        stamp = start + k * SECOND // 10
        bag.add(stamp, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
        pose = bag.make(POSE, bag.header(stamp), bag.pose(0.1 * k, 2.0, 0.5))
        bag.add(stamp, "/mocap/robot", POSE, pose)
    return bag
