# SPDX-License-Identifier: Apache-2.0
"""What a user can say about a log that the log does not say itself."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.errors import SettingsError
from slipwise.log_fields import LOG_FIELDS, About, Kind, LogFields
from slipwise.logs.held import UNKNOWN_AFTER

if TYPE_CHECKING:
    from slipwise.logs.vehicle_description import ThrottleSteering, VehicleDescription

AUTO = "auto"


def vehicle_file(vehicle: str | None) -> Path | None:
    """Return the file that describes a vehicle; None where it is a preset, whose name has no dot."""
    return None if vehicle is None or "." not in vehicle else Path(vehicle)


@dataclass(frozen=True)
class LogOptions(LogFields):
    """How to read a log; whatever is None is guessed, and the guess is noted in the log.

    Raises:
        SettingsError: a length or a size is not positive, a time or an angle is no number, or a factor is 0.
    """

    other_poses: tuple[Path, ...] = ()  # files of further sources of poses, beside `poses`
    other_pose_topics: tuple[str, ...] = ()  # topics of further sources, beside the pose topic
    unknown_after: float = UNKNOWN_AFTER  # [s] an input is unknown once it is older than this

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> LogOptions:
        """Return options from values as a settings file has them: lists, and paths as text."""
        given = dict(values)
        for about in LOG_FIELDS:
            value = given.get(about.name)
            if about.kind in _SEVERAL and value is not None:
                whole = about.kind is Kind.files
                first, *others = [Path(v) if whole else v for v in _listed(value)]
                further = {_FURTHER[about.name]: tuple(others)} if others else {}
                given = {**given, about.name: first} | further
            elif isinstance(value, list):
                given[about.name] = tuple(value)
        return cls(**given)

    def __post_init__(self) -> None:
        self._take_vehicle()
        for about in LOG_FIELDS:
            _check(about, getattr(self, about.name))
        self._check_sources()
        if self.start is not None and self.end is not None and self.end <= self.start:
            raise SettingsError(
                f"--end ({self.end:g} s) is not after --start ({self.start:g} s)", advice="exchange them"
            )
        if not self.unknown_after > 0.0:
            raise SettingsError("unknown_after must be more than 0 s", advice="such as 0.5")

    @property
    def wheels(self) -> VehicleDescription | None:
        """The vehicle, where its description names each wheel."""
        described = self._described()
        return described if described is not None and described.wheels else None

    @property
    def sideways(self) -> bool:
        """Whether the vehicle drives sideways, on omni or mecanum wheels or where each wheel is steered."""
        wheels = self.wheels
        if wheels is None or wheels.layout is None:
            return False
        rollers = any(wheel.roller is not None for wheel in wheels.wheels)
        steered = all(wheel.steer is not None for wheel in wheels.wheels)
        return (rollers or steered) and wheels.layout.tells_sideways

    @property
    def car(self) -> ThrottleSteering | None:
        """What is taken of a car commanded by throttle and steering, where the vehicle is one."""
        described = self._described()
        return None if described is None else described.throttle_steering

    @property
    def joints_described(self) -> bool:
        """Whether the names of the joints are those of the vehicle's description."""
        described = self._described()
        return described is not None and (self.left_joints, self.right_joints) == (
            tuple(described.left_joints),
            tuple(described.right_joints),
        )

    @property
    def files(self) -> tuple[Path, ...]:
        """Files that are read beside a log."""
        described = vehicle_file(self.vehicle)
        beside = (self.poses, *self.other_poses, described)
        return tuple(path for path in beside if path is not None)

    def _described(self) -> VehicleDescription | None:
        if self.vehicle is None:
            return None
        from slipwise.logs.vehicle_description import load_vehicle

        return load_vehicle(self.vehicle)

    def _take_vehicle(self) -> None:
        """Take the sizes that the vehicle's description has and the options lack."""
        described = self._described()
        if described is None:
            return
        sizes: dict[str, object] = {"wheelbase": described.wheelbase}
        if described.tracks is not None:
            sizes |= {
                "wheel_radius": described.tracks.radius,
                "wheel_separation": described.tracks.separation,
            }
        if not (self.left_joints or self.right_joints):
            joints = (tuple(described.left_joints), tuple(described.right_joints))
            sizes |= {"left_joints": joints[0] or None, "right_joints": joints[1] or None}
        for name, size in sizes.items():
            if size is not None and not getattr(self, name):
                object.__setattr__(self, name, size)
        if self.wheel_scale == (1.0, 1.0):
            object.__setattr__(self, "wheel_scale", described.wheel_scale)

    def _check_sources(self) -> None:
        """Refuse further sources without a first, or two of one name."""
        files = [path.stem for path in (self.poses, *self.other_poses) if path is not None]
        topics = [name for name in (self.pose_topic, *self.other_pose_topics) if name is not None]
        further = (
            ("poses", files, len(self.other_poses)),
            ("pose_topic", topics, len(self.other_pose_topics)),
        )
        for what, names, others in further:
            if others and len(names) == others:
                raise SettingsError(
                    f"further {_option(what)} need a first one", advice=f"give {_option(what)}"
                )
            if len(set(names)) < len(names):
                raise SettingsError(f"two sources of {_option(what)} have one name", advice="name each apart")


class RobotOptions(LogOptions):
    """What settings of a robot say of its logs of all kinds: what one kind has nothing of may stand."""


_SEVERAL = (Kind.topics, Kind.files)
_FURTHER = {"pose_topic": "other_pose_topics", "poses": "other_poses"}
_UNITS = {"METRES": "metres", "SECONDS": "seconds", "RADIANS": "radians"}
_ADVICE = {
    "METRES": "measure it on the robot",
    "SECONDS": "such as 12.5",
    "RADIANS": "3.1416 is half a turn",
}


def _listed(value: Any) -> Sequence[Any]:
    return value if isinstance(value, (list, tuple)) else [value]


def _check(about: About, value: Any) -> None:
    """Refuse a value that no log has."""
    if about.kind is Kind.factors:
        if len(value) != 2 or not all(math.isfinite(factor) and factor != 0.0 for factor in value):
            raise SettingsError(
                f"{about.option} must be two factors, of speed and yaw rate, neither of them 0",
                advice="such as 0.15,1 for wheels of 0.15 m whose speed is in rad/s, or -1,1 for a sign",
            )
        return
    automatic = about.kind is Kind.number_or_auto
    if about.metavar not in _UNITS or value is None or (automatic and value == AUTO):
        return
    finite = isinstance(value, (int, float)) and math.isfinite(value)
    positive = about.kind is Kind.positive
    if not finite or (positive and not value > 0.0):
        raise SettingsError(
            f"{about.option} must be a {'positive ' if positive else ''}number of "
            f"{_UNITS[about.metavar]}, not {value}",
            advice=_ADVICE[about.metavar] + (", or auto" if automatic else ""),
        )


def _option(name: str) -> str:
    """Return the option of the command line that sets a field."""
    return f"--{name.replace('_', '-')}"
