# SPDX-License-Identifier: Apache-2.0
"""A simulated robot that MPPI drives along a slalom: what it measures, and where it really is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.planning import Controller, Motion, MppiOptions, ReferencePath
from slipwise_sim import LandTamer, LiveRobot, World
from slipwise_sim.demo.slalom_course import SlalomCourse

Floats = NDArray[np.float64]

TICK = 0.01  # [s] of the robot; all periods are whole numbers of it
CONTROL_TICKS = 5  # commands and poses, 20 Hz
WHEEL_TICKS = 2  # 50 Hz
POSE_STD = (0.01, 0.003)  # [m], [rad] of measured poses, as of RTK
FRAME = "map"  # of the poses
WHEEL_STD = (0.01, 0.01)  # [m/s], [rad/s] of measured wheel speeds
END = 2.0  # [m] before the path's end the drive is over: the reference stands still there
PATIENCE = 2.5  # times the time that the path takes at its speed, after which a drive is given up

#: The same for every model. They were chosen for the vendor's constants: docs/results.md.
OPTIONS = MppiOptions(rollouts=1024, across=20.0, smoothness=0.005, period=TICK * CONTROL_TICKS)


@dataclass(frozen=True, eq=False)
class Trace:
    """What really happened, one row a control period."""

    t: Floats  # [N] s
    xy: Floats  # [N, 2] m
    left: Floats  # [N] m that the robot is to the left of the path
    floor: NDArray[np.int64]  # [N] which floor it was on


class SlalomDrive:
    """Drives from the start of a course to its end. The same course, models and seed give the same drive.

    Args:
        course: the path and its floors.
        motions: what the controller drives through until `adopt` gives it others.
        seed: of the noise of poses and wheel speeds, and of the controller's samples.
        options: of the controller; its period must be that of poses here.

    Raises:
        SlipwiseError: MuJoCo is not installed.
    """

    def __init__(
        self,
        course: SlalomCourse,
        motions: Sequence[Motion],
        *,
        seed: int,
        options: MppiOptions = OPTIONS,
    ) -> None:
        self.course = course
        self.floor = course.floor_at(0.0)
        law = course.floors[self.floor].law
        self._robot = LiveRobot(World(LandTamer(), "tyre-force", law), period=TICK)
        self._path = ReferencePath(course.points, course.speed)  # on which the true pose is looked for
        self._rng = np.random.Generator(np.random.PCG64(seed))
        self._controller = Controller(
            list(motions), ReferencePath(course.points, course.speed), options=replace(options, seed=seed)
        )
        self._state = self._robot.state()
        self._ticks = 0
        self._wheels = Wheels(0.0, 0.0, 0.0)
        self._rows: list[tuple[float, ...]] = []

    @property
    def t(self) -> float:
        """Time since the start [s]."""
        return self._ticks * TICK

    @property
    def arrived(self) -> bool:
        """Whether the robot has reached the end of the course."""
        return self._path.progress >= self._path.length - END

    @property
    def finished(self) -> bool:
        """Whether the drive is over: arrived, or given up."""
        return self.arrived or self.t >= PATIENCE * self._path.length / self.course.speed

    @property
    def trace(self) -> Trace:
        """What really happened until now."""
        rows = np.array(self._rows).reshape(-1, 5)
        return Trace(rows[:, 0], rows[:, 1:3], rows[:, 3], rows[:, 4].astype(np.int64))

    def adopt(self, motions: Sequence[Motion]) -> None:
        """Let the controller drive through other models from its next command on."""
        self._controller.adopt(list(motions))

    def advance(self) -> list[Sample]:
        """Measure the pose, command by it, and drive for one control period.

        Returns:
            What was commanded and measured, in the order of the stamps.
        """
        pose = self._measured_pose()
        seen = (pose.x, pose.y, pose.yaw)
        v, omega = self._controller.command(seen, (self._wheels.v, self._wheels.omega))
        samples: list[Sample] = [Command(self.t, v, omega), pose]
        for _ in range(CONTROL_TICKS):
            if self._ticks % WHEEL_TICKS == 0:
                samples.append(self._measured_wheels())
            self._state = self._robot.tell(v, omega)
            self._ticks += 1
            self._look_down()
        self._record()
        return samples

    def _measured_pose(self) -> Pose:
        x, y, yaw = self._state.pose + self._rng.standard_normal(3) * (POSE_STD[0], POSE_STD[0], POSE_STD[1])
        return Pose(self.t, float(x), float(y), float(yaw), *POSE_STD, frame=FRAME)

    def _measured_wheels(self) -> Wheels:
        v, omega = self._state.drive + self._rng.standard_normal(2) * WHEEL_STD
        self._wheels = Wheels(self.t, float(v), float(omega))
        return self._wheels

    def _look_down(self) -> None:
        floor = self.course.floor_at(self._state.pose[0])
        if floor != self.floor:
            self.floor = floor
            self._robot.stand_on(self.course.floors[floor].law)

    def _record(self) -> None:
        x, y = self._state.pose[:2]
        self._path.progress, left = self._path.nearest((x, y))
        self._rows.append((self.t, x, y, left, self.floor))
