# SPDX-License-Identifier: Apache-2.0
"""How a log is read: the one place that declares key, option, default and help.

`LogOptions`, the options of the command line, the table [log] of a settings file and its rows in
docs/settings.md are made from these fields.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple


class Kind(Enum):
    """What a value is; the command line and the settings file write it in their own ways."""

    text = "text"
    topics = "topics"  # one or several
    files = "files"  # one or several
    names = "names"  # a list
    positive = "positive"  # a number above 0
    number = "number"
    number_or_auto = "number or auto"
    factors = "factors"  # two numbers, neither of them 0
    columns = "columns"  # tidy name: name in the table


class About(NamedTuple):
    """The description of a field."""

    name: str
    kind: Kind
    metavar: str
    help: str
    example: str  # value in a settings file, shown where the default is none
    default: Any
    key: bool  # whether a settings file has it too; else it is of one log, or a vehicle's file says it

    @property
    def option(self) -> str:
        """The option of the command line."""
        return f"--{self.name.replace('_', '-')}"


def _key(  # noqa: PLR0913 - what is declared once
    kind: Kind, metavar: str, text: str, *, default: Any = None, example: str = "", key: bool = True
) -> Any:
    about = {"kind": kind, "metavar": metavar, "help": text, "example": example, "key": key}
    if kind is Kind.columns:  # a dict is no default of a field
        return field(default_factory=dict, metadata=about)
    return field(default=default, metadata=about)


@dataclass(frozen=True)
class LogFields:
    """What a user says about a log; slipwise guesses what is None, and notes the guess in the log."""

    pose_topic: str | None = _key(
        Kind.topics,
        "TOPIC",
        "Measured pose: Odometry, Pose[WithCovariance]Stamped, NavSatFix or TFMessage. Repeat it for further "
        "pose sources.",
        example='"/rtk/odom"',
    )
    command_topic: str | None = _key(
        Kind.text,
        "TOPIC",
        "Commands: Twist, TwistStamped or AckermannDriveStamped; none: read no commands.",
        example='"/cmd_vel"',
    )
    wheel_topic: str | None = _key(
        Kind.text,
        "TOPIC",
        "Wheel odometry: Odometry (its twist) or JointState; none: read no wheels.",
        example='"/odom"',
    )
    imu_topic: str | None = _key(
        Kind.text,
        "TOPIC",
        "Imu: orientation or yaw rate beside a NavSatFix, tilt beside poses; alone with --pose-topic none.",
        example='"/imu/data"',
    )
    pose_frame: str | None = _key(Kind.text, "FRAME", "TF: the fixed frame.", example='"map"')
    child_frame: str | None = _key(Kind.text, "FRAME", "TF: the robot's frame.", example='"base_link"')
    left_joints: tuple[str, ...] = _key(
        Kind.names,
        "NAMES",
        "JointState: names of the left wheels, separated by commas.",
        default=(),
        key=False,
    )
    right_joints: tuple[str, ...] = _key(
        Kind.names,
        "NAMES",
        "JointState: names of the right wheels, separated by commas.",
        default=(),
        key=False,
    )
    wheel_radius: float | None = _key(
        Kind.positive, "METRES", "Wheel radius, for wheel speeds in rad/s.", example="0.1"
    )
    wheel_separation: float | None = _key(
        Kind.positive,
        "METRES",
        "Distance between left and right wheels, for wheel speeds in rad/s.",
        example="0.5",
    )
    wheelbase: float | None = _key(
        Kind.positive, "METRES", "Distance between the axles, for steering angles.", example="1.2", key=False
    )
    vehicle: str | None = _key(
        Kind.text,
        "NAME",
        "What the robot drives on: a preset such as husky, or a .yaml file (vehicles.md).",
        example='"husky"',
    )
    command_scale: tuple[float, float] = _key(
        Kind.factors,
        "V,OMEGA",
        "Factors of the commanded speed and yaw rate (or steering, curvature): 0.15,1 for rad/s of 0.15 m "
        "wheels; -1,1 for a sign.",
        default=(1.0, 1.0),
    )
    wheel_scale: tuple[float, float] = _key(
        Kind.factors,
        "V,OMEGA",
        "The same factors for the speed and yaw rate of the wheels.",
        default=(1.0, 1.0),
        key=False,
    )
    pose_yaw_offset: float = _key(
        Kind.number,
        "RADIANS",
        "Added to the heading of every pose: 3.1416 if the pose sensor looks backwards. Roll and pitch turn "
        "with it.",
        default=0.0,
        key=False,
    )
    poses: Path | None = _key(
        Kind.files,
        "FILE",
        "Measured poses in a file beside the log: TUM, KITTI, a table, GPX, NMEA or .pos. Repeat it for "
        "further pose sources.",
        example='"lidar_tum.txt"',
        key=False,
    )
    pose_clock_offset: float | str | None = _key(
        Kind.number_or_auto,
        "SECONDS",
        "Added to the stamps of all poses; auto finds it from the motion that inputs and poses share.",
        example='"auto"',
        key=False,
    )
    command_timeout: float | None = _key(
        Kind.positive,
        "SECONDS",
        "The robot's watchdog ends a command that is not repeated for so long; default: commands are held.",
        example="0.5",
    )
    start: float | None = _key(
        Kind.number,
        "SECONDS",
        "Leave out what comes before, counted from the log's start.",
        example="10.0",
        key=False,
    )
    end: float | None = _key(
        Kind.number,
        "SECONDS",
        "Leave out what comes after, counted from the log's start.",
        example="60.0",
        key=False,
    )
    columns: Mapping[str, str] = _key(
        Kind.columns,
        "NAMES",
        "Columns of a table under other names: t=time,cmd_v=vx, or by number from 0: t=0,cmd_v=1.",
    )


LOG_FIELDS = tuple(
    About(
        name=each.name, default={} if each.metadata["kind"] is Kind.columns else each.default, **each.metadata
    )
    for each in fields(LogFields)
)
