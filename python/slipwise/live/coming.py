# SPDX-License-Identifier: Apache-2.0
"""What will be measured, as far as the first lines show it before a learner is made."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np

from slipwise.calibration.coming import Coming
from slipwise.live.samples import Command, KnownForce, Pose, Reading, Sample, Wheels
from slipwise.logs.attitude import was_measured
from slipwise.logs.gyro import COLUMN as GYRO
from slipwise.logs.vocabulary import measured_by

ENOUGH = 2.0  # s of samples, in which what is there shows itself
LONGEST = 10.0  # s without a pose, after which none is waited for


@dataclass(frozen=True, kw_only=True)
class ComingLines(Coming):
    """The same of lines that do not say what they are."""

    input_name: str = "wheel"  # what motion is predicted from, where nobody says it


class ComingSoon:
    """Looks at the first samples of a stream of lines."""

    def __init__(self) -> None:
        self._first, self._last = math.inf, -math.inf
        self._poses: list[Pose] = []
        self._others: set[type | str] = set()  # columns of readings
        self._sideways = False

    def take(self, samples: Iterable[Sample]) -> None:
        """Take samples in the order in which they come."""
        for sample in samples:
            if isinstance(sample, Pose):
                self._poses.append(sample)
            if isinstance(sample, Command | Wheels):
                self._sideways = self._sideways or sample.vy != 0.0
            if isinstance(sample, Command | Wheels | Pose | Reading | KnownForce):
                self._others.add(sample.column if isinstance(sample, Reading) else type(sample))
                if math.isfinite(sample.t):
                    self._first, self._last = min(self._first, sample.t), max(self._last, sample.t)

    @property
    def enough(self) -> bool:
        """Whether more samples would show nothing else."""
        seconds = self._last - self._first
        return seconds >= LONGEST or (seconds >= ENOUGH and bool(self._poses))

    def found(self, columns: Collection[str]) -> ComingLines:
        """Return what comes, by the samples and by the columns of the lines; some may be empty yet."""
        names = tuple(dict.fromkeys(pose.source for pose in self._poses if pose.source))
        fixes = "fix" in columns and bool(self._poses)
        first = [pose for pose in self._poses if pose.source in ("", *names[:1])]
        headed = any(math.isfinite(pose.yaw) for pose in first)
        tilts = [angle for pose in first for angle in (pose.roll, pose.pitch) if angle is not None]
        return ComingLines(
            positions=bool(self._poses) and not headed,
            gyro_alone=GYRO in self._others and not self._poses and "x" not in columns,
            sources=names if len(names) > 1 else (names or ("",) if fixes else ()),
            attitude=was_measured(np.array(tilts)) or KnownForce in self._others,
            sideways=self._sideways or bool({"cmd_vy", "odo_vy"} & set(columns)),
            input_name=self._input(columns),
        )

    def _input(self, columns: Collection[str]) -> str:
        """Commands where they come, as of a log."""
        if Command in self._others or Wheels in self._others:
            return "command" if Command in self._others else "wheel"
        return "command" if any(measured_by(name) == "command" for name in columns) else "wheel"
