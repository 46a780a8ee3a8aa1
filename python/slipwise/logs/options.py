# SPDX-License-Identifier: Apache-2.0
"""What a user can say about a log that the log does not say itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.errors import SettingsError
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.remote import MOST_FETCHED
from slipwise.logs.unpacking import LARGEST_UNPACKED, MOST_UNPACKED

if TYPE_CHECKING:
    from slipwise.logs.vehicle_description import ThrottleSteering, VehicleDescription

AUTO = "auto"


@dataclass(frozen=True)
class LogOptions:
    """How to read a log; whatever is None is guessed, and the guess is noted in the log.

    Raises:
        SettingsError: a length or a size is not positive, a time or an angle is no number, or a factor is 0.
    """

    command_topic: str | None = None  # Twist[Stamped] or AckermannDriveStamped
    pose_topic: str | None = None  # Odometry, Pose[WithCovariance]Stamped, NavSatFix or TFMessage
    wheel_topic: str | None = None  # Odometry (its twist) or JointState
    imu_topic: str | None = None  # Imu: orientation beside a NavSatFix, tilt beside planar poses
    pose_frame: str | None = None  # TF: the fixed frame, such as "map"
    child_frame: str | None = None  # TF: the robot, such as "base_link"
    left_joints: tuple[str, ...] = ()  # JointState: wheels of the left side, by name
    right_joints: tuple[str, ...] = ()
    wheel_radius: float | None = None  # [m]
    wheel_separation: float | None = None  # [m] between the left and the right wheels
    wheelbase: float | None = None  # [m] between the axles, for steering angles
    vehicle: str | None = None  # a preset or a .yaml file that says what the robot drives on
    command_scale: tuple[float, float] = (1.0, 1.0)  # factors of the commanded speed and yaw rate
    wheel_scale: tuple[float, float] = (1.0, 1.0)  # the same of the wheels'; such as their radius, or -1
    pose_yaw_offset: float = 0.0  # [rad] added to the heading of every pose
    most_unpacked: float = MOST_UNPACKED  # [MiB] that a compressed table, or a chunk of a bag, may unpack to
    most_fetched: float = MOST_FETCHED  # [MiB] that a log on a server may have
    poses: Path | None = None  # a file with the measured poses, beside a log whose own are not used
    other_poses: tuple[Path, ...] = ()  # files of further sources of poses, beside these
    other_pose_topics: tuple[str, ...] = ()  # topics of further sources, beside the pose topic
    pose_clock_offset: float | str | None = None  # [s] added to stamps of poses, or "auto" to find it
    command_timeout: float | None = None  # [s] after which the robot ends a command that is not repeated
    start: float | None = None  # [s] from the log's start; what is before is not used
    end: float | None = None  # [s] from the log's start; what is after is not used
    columns: Mapping[str, str] = field(default_factory=dict)  # tidy name -> name in the table
    unknown_after: float = UNKNOWN_AFTER  # [s] an input is unknown once it is older than this

    def __post_init__(self) -> None:
        self._take_vehicle()
        if self.command_timeout is not None and not 0.0 < self.command_timeout < math.inf:
            what = f"--command-timeout must be a positive number of seconds, not {self.command_timeout}"
            raise SettingsError(what, advice="such as 0.5, as the robot's watchdog has it")
        for name in ("wheel_radius", "wheel_separation", "wheelbase"):
            value: float | None = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise SettingsError(
                    f"{_option(name)} must be a positive number of metres, not {value}",
                    advice="measure it on the robot",
                )
        self._check_corrections()
        self._check_sources()
        for name, usual in (("most_unpacked", MOST_UNPACKED), ("most_fetched", MOST_FETCHED)):
            size: float = getattr(self, name)
            if not 0.0 < size <= LARGEST_UNPACKED:
                raise SettingsError(
                    f"{name} must be a positive number of MiB, not {size}",
                    advice=f"the default is {usual:g}, the most {LARGEST_UNPACKED:g}",
                )
        for name in ("start", "end", "pose_clock_offset"):
            given = getattr(self, name)
            automatic = name == "pose_clock_offset"
            if given is None or (automatic and given == AUTO):
                continue
            if not (isinstance(given, (int, float)) and math.isfinite(given)):
                advice = f"such as 12.5{', or auto' if automatic else ''}"
                raise SettingsError(
                    f"{_option(name)} must be a number of seconds, not {given}", advice=advice
                )
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
    def files(self) -> tuple[Path, ...]:
        """Files that are read beside a log."""
        described = () if self.vehicle is None or "." not in self.vehicle else (Path(self.vehicle),)
        return (*(() if self.poses is None else (self.poses,)), *self.other_poses, *described)

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

    def _check_corrections(self) -> None:
        for name in ("command_scale", "wheel_scale"):
            factors: tuple[float, ...] = getattr(self, name)
            if len(factors) != 2 or not all(math.isfinite(factor) and factor != 0.0 for factor in factors):
                raise SettingsError(
                    f"{_option(name)} must be two factors, of speed and yaw rate, neither of them 0",
                    advice="such as 0.15,1 for wheels of 0.15 m whose speed is in rad/s, or -1,1 for a sign",
                )
        if not math.isfinite(self.pose_yaw_offset):
            raise SettingsError("--pose-yaw-offset must be in radians", advice="3.1416 is half a turn")


def _option(name: str) -> str:
    """Return the option of the command line that sets a field."""
    return f"--{name.replace('_', '-')}"
