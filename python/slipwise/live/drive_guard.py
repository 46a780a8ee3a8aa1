# SPDX-License-Identifier: Apache-2.0
"""Says when a robot that drives by itself must stop: dead man's button, pose, area."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from slipwise.live.samples import Pose

JUMP = 0.5  # m that a pose may move beyond twice the speed limit, before it counts as a jump
STILL = 0.1  # m that a robot may move while it is to stand


@dataclass(frozen=True)
class DriveBounds:
    """Within what the robot drives by itself."""

    left: float  # m, least x of base_link, seen from where it starts and along its first heading
    right: float  # m, largest x
    bottom: float  # m, least y
    top: float  # m, largest y
    speed: float  # m/s at most
    yaw_rate: float  # rad/s at most
    dead_man_within: float = 0.25  # s, for which the newest word of the dead man's button holds
    pose_within: float = 0.5  # s, for which a pose holds


class DriveGuard:
    """Takes what is heard, from any thread; `wake` is set where the robot must stop at once.

    Once it must stop, it must: a button that is pressed again changes nothing.

    Args:
        bounds: within what the robot drives.
        clock: counts seconds.
    """

    def __init__(self, bounds: DriveBounds, *, clock: Callable[[], float] = time.monotonic) -> None:
        self.bounds, self._clock = bounds, clock
        self.wake = threading.Event()
        self.caused_at = math.nan  # s of the clock, when it turned out that the robot must stop
        self.room_left = math.inf  # m, the least between base_link and the bounds so far
        self.poses = 0
        self._lock = threading.Lock()
        self._pressed, self._pressed_at = False, -math.inf
        self._pose: Pose | None = None
        self._pose_at = -math.inf
        self._start: Pose | None = None
        self._driving = False
        self._trouble = ""

    def take_dead_man(self, pressed: bool) -> None:
        """Take whether the dead man's button is pressed."""
        with self._lock:
            self._pressed, self._pressed_at = pressed, self._clock()
            if self._driving and not pressed:
                self._stop("the dead man's button was released")

    def take_pose(self, pose: Pose) -> None:
        """Take a pose; one whose stamp is no newer than the last, or that is no pose, counts as none."""
        if not math.isfinite(pose.t + pose.x + pose.y + pose.yaw):
            return
        with self._lock:
            before = self._pose
            if before is not None and pose.t <= before.t:
                return
            self._pose, self._pose_at = pose, self._clock()
            self.poses += 1
            if self._driving and before is not None:
                self._watch(pose, before)

    def not_ready(self) -> str:
        """Return what is missing before the drive; empty where nothing is."""
        with self._lock:
            if self._pose is None:
                return "a pose"
            if self._stale(self._pose_at, self.bounds.pose_within):
                return "a pose: the last one is old"
            if not self._pressed or self._stale(self._pressed_at, self.bounds.dead_man_within):
                return "the dead man's button: press it, and hold it"
            return ""

    def stand(self) -> None:
        """Take the newest pose as the place where the robot stands."""
        with self._lock:
            self._start = self._pose

    def stands(self) -> bool:
        """Whether the robot is where it stood."""
        with self._lock:
            if self._start is None or self._pose is None:
                return False
            return math.dist((self._start.x, self._start.y), (self._pose.x, self._pose.y)) <= STILL

    def begin(self) -> None:
        """The drive begins here: bounds count from the newest pose."""
        with self._lock:
            self._start, self._driving = self._pose, True
            self._trouble, self.room_left, self.poses = "", math.inf, 0
            self.wake.clear()

    def trouble(self) -> str:
        """Return why the robot must stop now; empty where it may drive on."""
        with self._lock:
            if not self._trouble and self._driving:
                if self._stale(self._pressed_at, self.bounds.dead_man_within):
                    self._stop("nothing is heard of the dead man's button")
                elif self._stale(self._pose_at, self.bounds.pose_within):
                    self._stop("no pose comes")
            return self._trouble

    def _watch(self, pose: Pose, before: Pose) -> None:
        start, bounds = self._start, self.bounds
        if start is None:
            return
        moved = math.dist((pose.x, pose.y), (before.x, before.y))
        if pose.frame != start.frame:
            self._stop(f"poses are in another frame: {pose.frame!r}")
        elif moved > JUMP + 2.0 * bounds.speed * (pose.t - before.t):
            self._stop(f"the pose jumped by {moved:.2f} m")
        c, s = math.cos(start.yaw), math.sin(start.yaw)
        dx, dy = pose.x - start.x, pose.y - start.y
        x, y = c * dx + s * dy, c * dy - s * dx
        left = min(x - bounds.left, bounds.right - x, y - bounds.bottom, bounds.top - y)
        self.room_left = min(self.room_left, left)
        if left < 0.0:
            self._stop("the robot leaves its area")

    def _stale(self, heard: float, within: float) -> bool:
        return self._clock() - heard > within

    def _stop(self, why: str) -> None:
        if not self._trouble:
            self._trouble, self.caused_at = why, self._clock()
            self.wake.set()
