# SPDX-License-Identifier: Apache-2.0
"""What will be measured, as far as it shows before a learner is made."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any

from slipwise.calibration.sloping_ground import drives_sideways, has_attitude, has_known_force
from slipwise.live.samples import Command, Gyro, KnownForce, Pose, Sample, Wheels
from slipwise.logs.gyro import gyro_alone
from slipwise.logs.log import Log, has_course
from slipwise.logs.vocabulary import measured_by
from slipwise.segments import source_names

ENOUGH = 2.0  # s of samples, in which what is there shows itself
LONGEST = 10.0  # s without a pose, after which none is waited for


@dataclass(frozen=True)
class Coming:
    """What a learner has to know of the measurements that will come."""

    positions: bool = False  # poses come without a heading
    gyro_alone: bool = False  # no poses come, and turns of a gyro are learned from
    sources: tuple[str, ...] = ()  # of poses, where sources or fixes are distinguished
    attitude: bool = False  # roll and pitch, or a known force: terms of gravity are tried
    sideways: bool = False  # the robot drives sideways too
    input_name: str = "wheel"  # what motion is predicted from, where nobody says it

    def words(self) -> str:
        """Say what is particular, behind a sentence."""
        said = {
            "poses are positions, their headings the direction of the path": self.positions,
            "turns of a gyro are all that is measured": self.gyro_alone,
            f"poses of {', '.join(self.sources)}": len(self.sources) > 1,
            "with terms of gravity": self.attitude,
            "with terms of sideways speed": self.sideways,
        }
        return "".join(f"; {words}" for words, so in said.items() if so)

    def settings(self) -> dict[str, Any]:
        """Return what of it is not as the settings of [live] have it, where nothing is said there."""
        found = {
            name: getattr(self, name) or None for name in ("positions", "gyro_alone", "attitude", "sideways")
        }
        return found | {"sources": list(self.sources) or None}


def coming_of(log: Log) -> Coming:
    """Return what comes where a log is replayed."""
    return Coming(
        positions=has_course(log.runs),
        gyro_alone=gyro_alone(log.runs),
        sources=source_names(log.runs),
        attitude=has_known_force(log) or has_attitude(log),
        sideways=drives_sideways(log),
    )


class ComingSoon:
    """Looks at the first samples of a stream of lines."""

    def __init__(self) -> None:
        self._first, self._last = math.inf, -math.inf
        self._poses: list[Pose] = []
        self._others: set[type] = set()
        self._sideways = False

    def take(self, samples: Iterable[Sample]) -> None:
        """Take samples in the order in which they come."""
        for sample in samples:
            if isinstance(sample, Pose):
                self._poses.append(sample)
            if isinstance(sample, Command | Wheels):
                self._sideways = self._sideways or sample.vy != 0.0
            if isinstance(sample, Command | Wheels | Pose | Gyro | KnownForce):
                self._others.add(type(sample))
                if math.isfinite(sample.t):
                    self._first, self._last = min(self._first, sample.t), max(self._last, sample.t)

    @property
    def enough(self) -> bool:
        """Whether more samples would show nothing else."""
        seconds = self._last - self._first
        return seconds >= LONGEST or (seconds >= ENOUGH and bool(self._poses))

    def found(self, columns: Collection[str]) -> Coming:
        """Return what comes, by the samples and by the columns of the lines; some may be empty yet."""
        names = tuple(dict.fromkeys(pose.source for pose in self._poses if pose.source))
        fixes = "fix" in columns and bool(self._poses)
        headed = any(math.isfinite(pose.yaw) for pose in self._poses if pose.source in ("", *names[:1]))
        tilted = any(pose.roll or pose.pitch for pose in self._poses)
        return Coming(
            positions=bool(self._poses) and not headed,
            gyro_alone=Gyro in self._others and not self._poses and "x" not in columns,
            sources=names if len(names) > 1 else (names or ("",) if fixes else ()),
            attitude=tilted or KnownForce in self._others,
            sideways=self._sideways or bool({"cmd_vy", "odo_vy"} & set(columns)),
            input_name=self._input(columns),
        )

    def _input(self, columns: Collection[str]) -> str:
        """Commands where they come, as of a log."""
        if Command in self._others or Wheels in self._others:
            return "command" if Command in self._others else "wheel"
        return "command" if any(measured_by(name) == "command" for name in columns) else "wheel"
