# SPDX-License-Identifier: Apache-2.0
"""What is looked at to find what is wrong: poses against inputs in windows, and the log where it is whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from slipwise import _core
from slipwise.logs.findings.driven_windows import DrivenWindows, driven_windows
from slipwise.logs.findings.plausibility import Agreement, agreement
from slipwise.logs.findings.steering import Commanded
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Log
from slipwise.logs.motion_windows import MotionWindows, motion_windows


@dataclass(frozen=True)
class InputWords:
    """How one kind of input is called."""

    input_name: str  # "command" or "wheel"
    name: str  # "commands" or "wheels"
    speed: str  # its speed
    option: str  # that scales it
    drives: str  # why the robot should move

    def scaled(self, factors: str) -> str:
        """Return the option with factors that hold for a log as it was read, with those that were given."""
        return f"{self.option} {factors} (times those in force)"


WORDS = {
    "command": InputWords("command", "commands", "the commanded speed", "--command-scale", "it is commanded"),
    "wheel": InputWords("wheel", "wheels", "the speed of the wheels", "--wheel-scale", "its wheels turn"),
}
OTHER = {"command": "wheel", "wheel": "command"}


Place = tuple[float, float, float]  # x, y [m], yaw [rad]
AT_CENTRE: Place = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class WholeLog:
    """A log, for what only whoever has all of it knows."""

    log: Log
    input_name: str  # "command" or "wheel", the input that is learned from
    unknown_after: float = UNKNOWN_AFTER  # [s] an input is unknown once it is older than this


@dataclass(frozen=True, eq=False)
class Seen:
    """Poses against inputs, of a log or of what came live so far."""

    evidence: _core.MotionEvidence | _core.RecentEvidence
    runs: Sequence[str]  # names, by the evidence's number of the run
    input_name: str  # "command" or "wheel", the input that is learned from
    positions: bool  # headings are courses, which tell nothing of a heading
    gyro: bool  # turns of a gyro are learned from
    sensor: Place  # where the pose sensor is known to sit on the robot
    commanded: Commanded = Commanded()  # what the commands are

    @property
    def sensor_yaw(self) -> float:
        """How the pose sensor is known to be turned on the robot [rad]."""
        return self.sensor[2]

    @property
    def words(self) -> InputWords:
        """How the input that is learned from is called."""
        return WORDS[self.input_name]

    @property
    def other_words(self) -> InputWords:
        """How the other input is called."""
        return WORDS[OTHER[self.input_name]]

    @cached_property
    def windows(self) -> MotionWindows:
        """The windows of the input that is learned from, between poses that a learner uses."""
        return self.windows_of(self.input_name)

    @cached_property
    def driven(self) -> DrivenWindows:
        """The windows in which that input drives the robot along a line."""
        return driven_windows(self.windows, self.sensor_yaw)

    @cached_property
    def other_driven(self) -> DrivenWindows:
        """The same of the other input."""
        return driven_windows(self.windows_of(OTHER[self.input_name]), self.sensor_yaw)

    def windows_of(self, input_name: str) -> MotionWindows:
        """Return the windows of one kind of input, between poses that a learner uses."""
        return motion_windows(self.evidence.windows, input_name)

    def agreement(self, input_name: str) -> Agreement:
        """Say how well one kind of input agrees with the poses as they were measured."""
        return agreement(motion_windows(self.evidence.measured_windows, input_name))
