# SPDX-License-Identifier: Apache-2.0
"""A simulated robot on a wire of ROS that does as it is commanded, and a person who holds a button."""

from __future__ import annotations

import math
import threading
import time

from live.wires.wire_messages import from_cdr, to_cdr

from slipwise.live.ros_messages import stamp_ns
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import RosWire
from slipwise.simulation import LandTamer, LiveRobot, TyreLaw, World

PERIOD = 0.05  # s
TIMEOUT = 0.5  # s, for which a command holds, as diff_drive_controller has it
TWIST, BOOL, POSE = "geometry_msgs/msg/Twist", "std_msgs/msg/Bool", "geometry_msgs/msg/PoseStamped"


class DrivenRobot:
    """Publishes /pose and /dead_man, and hears /cmd_vel.

    Args:
        wire: its own.
        release_at: commands that drive, after which the button is released; None: never.
        silent_at: likewise, the button falls silent.
        blind_at: likewise, poses end.
    """

    def __init__(
        self,
        wire: RosWire,
        *,
        release_at: int | None = None,
        silent_at: int | None = None,
        blind_at: int | None = None,
    ) -> None:
        self._wire, self._release_at = wire, release_at
        self._silent_at, self._blind_at = silent_at, blind_at
        self.heard: list[tuple[float, float, float]] = []  # when [s], v, omega
        self.acted_at = 0.0  # s, when the button was released, or fell silent, or poses ended
        self._driving = 0
        self._robot = LiveRobot(World(LandTamer(), "tyre-force", TyreLaw()), period=PERIOD)
        self._ended = threading.Event()
        wire.subscribe("/cmd_vel", TWIST, self._take)
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._wire.close()

    @property
    def stood_after(self) -> float:
        """From what the person or the localiser did to the first command to stand that came [s]."""
        return next(t for t, v, omega in self.heard if t > self.acted_at and (v, omega) == (0.0, 0.0)) - (
            self.acted_at
        )

    def _take(self, payload: bytes) -> None:
        message = from_cdr(TWIST, payload)
        v, omega = message.linear.x, message.angular.z
        self.heard.append((time.monotonic(), v, omega))
        self._driving += bool(v or omega)
        if self._driving == self._release_at and not self.acted_at:
            self.acted_at = time.monotonic()
            self._say_pressed(pressed=False)

    def _live(self) -> None:
        begin = time.monotonic()
        for step in range(10**6):
            newest = self.heard[-1] if self.heard else (0.0, 0.0, 0.0)
            held = time.monotonic() - newest[0] < TIMEOUT
            state = self._robot.tell(*(newest[1:] if held else (0.0, 0.0)))
            silent, blind = self._reached(self._silent_at), self._reached(self._blind_at)
            if (silent or blind) and not self.acted_at:
                self.acted_at = time.monotonic()
            if not silent:
                self._say_pressed(pressed=not self._reached(self._release_at))
            if not blind:
                self._say_pose(state.pose)
            if self._ended.wait(max(0.0, begin + (step + 1) * PERIOD - time.monotonic())):
                return

    def _reached(self, count: int | None) -> bool:
        return count is not None and self._driving >= count

    def _say_pressed(self, *, pressed: bool) -> None:
        self._wire.publish("/dead_man", BOOL, to_cdr(BOOL, data=pressed))

    def _say_pose(self, pose: tuple[float, float, float]) -> None:
        types = ros_types().types
        x, y, yaw = pose
        stamp = types["builtin_interfaces/msg/Time"](*divmod(stamp_ns(time.time()), 1_000_000_000))
        turned = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        self._wire.publish(
            "/pose",
            POSE,
            to_cdr(
                POSE,
                header=types["std_msgs/msg/Header"](stamp, "map"),
                pose=types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](x, y, 0.0), turned),
            ),
        )
