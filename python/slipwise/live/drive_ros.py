# SPDX-License-Identifier: Apache-2.0
"""A robot on ROS that is driven: Twist out, poses and the dead man's button in, by any wire."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from slipwise.errors import SettingsError
from slipwise.live.cdr_reader import reader_of
from slipwise.live.drive_guard import DriveGuard
from slipwise.live.drive_link import DriveLog
from slipwise.live.ros_messages import stamp_ns
from slipwise.live.ros_samples import to_pose
from slipwise.live.stamps import Stamps
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import RosWire
from slipwise.logs.messages import ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE, TWIST, TWIST_STAMPED
from slipwise.logs.options import LogOptions

BOOL, JOY = "std_msgs/msg/Bool", "sensor_msgs/msg/Joy"
_POSES = (ODOMETRY, POSE_STAMPED, POSE_WITH_COVARIANCE)


@dataclass(frozen=True)
class DriveTopics:
    """Topics of a robot that drives by itself."""

    dead_man: str  # std_msgs/Bool or sensor_msgs/Joy
    pose: str
    command: str = "/cmd_vel"
    stamped: bool = False  # TwistStamped in place of Twist
    button: int = 0  # of a Joy


class RosDriveLink:
    """Connects to topics as they appear.

    Args:
        wire: carries the messages.
        topics: their names.
    """

    def __init__(self, wire: RosWire, topics: DriveTopics) -> None:
        self._wire, self._topics = wire, topics
        self._types = ros_types()
        self._stamps = Stamps()
        self._guard: DriveGuard | None = None
        self._heard: set[str] = set()
        self._kind = TWIST_STAMPED if topics.stamped else TWIST
        self.log = DriveLog()
        wire.advertise(topics.command, self._kind)

    def hear(self, guard: DriveGuard) -> None:
        """Hand poses and the dead man's button to a guard from now on."""
        self._guard = guard

    def missing(self) -> str:
        """Return what is not connected yet.

        Raises:
            SettingsError: a topic has another type, or somebody else commands the robot.
        """
        names, found = self._topics, {topic.name: topic for topic in self._wire.topics()}
        if names.command in found:
            raise SettingsError(
                f"somebody else publishes commands on {names.command}",
                where="--topic",
                advice="stop that node, or command a topic of your own that a multiplexer passes on",
            )
        for name, kinds in ((names.pose, _POSES), (names.dead_man, (BOOL, JOY))):
            if name in self._heard:
                continue
            if name not in found:
                return f"topic {name}"
            kind = found[name].type
            if kind not in kinds:
                raise SettingsError(
                    f"{name} is a {kind}", where=name, advice=f"give one of {', '.join(kinds)}"
                )
            self._subscribe(name, kind)
        return "" if self._wire.connections(names.command) else f"somebody who listens on {names.command}"

    def send(self, v: float, omega: float) -> None:
        """Command a speed [m/s] and a yaw rate [rad/s]."""
        now = time.time()
        types = self._types.types
        vector = types["geometry_msgs/msg/Vector3"]
        message = types[TWIST](vector(v, 0.0, 0.0), vector(0.0, 0.0, omega))
        if self._topics.stamped:
            stamp = types["builtin_interfaces/msg/Time"](*divmod(stamp_ns(now), 1_000_000_000))
            message = types[TWIST_STAMPED](types["std_msgs/msg/Header"](stamp, "base_link"), message)
        self._wire.publish(
            self._topics.command, self._kind, bytes(self._types.serialize_cdr(message, self._kind))
        )
        self.log.take_command(self._stamps.of(None, now), v, omega)

    def close(self) -> None:
        """Leave the graph."""
        self._wire.close()

    def _subscribe(self, name: str, kind: str) -> None:
        """Hear a topic; what cannot be read counts as nothing heard, so that the robot stops."""
        take = self._take_pose(kind) if kind in _POSES else self._take_dead_man
        read = reader_of(kind, self._types)
        self._wire.subscribe(name, kind, lambda payload: take(read(payload)))
        self._heard.add(name)

    def _take_pose(self, kind: str) -> Callable[[Any], None]:
        convert = to_pose(kind, LogOptions())

        def take(message: Any) -> None:
            pose = convert(message, self._stamps.of(message, time.time()))
            if pose is not None and self._guard is not None:
                self._guard.take_pose(pose)
                self.log.take_pose(pose.t, pose.x, pose.y, pose.yaw)

        return take

    def _take_dead_man(self, message: Any) -> None:
        if self._guard is None:
            return
        if hasattr(message, "buttons"):
            buttons, place = message.buttons, self._topics.button
            self._guard.take_dead_man(place < len(buttons) and bool(buttons[place]))
        else:
            self._guard.take_dead_man(bool(message.data))
