# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share, each stated once."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from slipwise.calibration import Settings
    from slipwise.logs import LogOptions


GRADE_HELP = "Ground that falls by SLOPE towards DOWNHILL, both in degrees, 0 along x."


class ForceFrame(StrEnum):
    """What a force that is learned beside slip stays fixed to."""

    body = "body"
    world = "world"


class InputName(StrEnum):
    """What a model is learned from."""

    command = "command"
    wheel = "wheel"


def optional(metavar: str, text: str, *names: str) -> Any:
    """Return an option that is left out by default; named by its parameter where no names are given."""
    return typer.Option(*names, metavar=metavar, show_default=False, help=text)


Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG...",
        show_default=False,
        help="Tidy CSV, CSV.gz or Parquet, or a ROS bag (.mcap, .db3, .bag, rosbag2 folder).",
    ),
]
Input = Annotated[
    InputName | None,
    typer.Option(
        "--input",
        show_default=False,
        help="Learn from commands or from wheel speeds; commands if the log has them.",
    ),
]
Basis = Annotated[
    str | None,
    optional("NAME", "Slip basis, such as edd-2 or odd-even-10; default auto, an average of several."),
]
Estimator = Annotated[
    str | None,
    optional(
        "NAME",
        "How to learn: average (the default, weighs bases by how well they predict), iekf, "
        "delayed-state, ekf-thesis, gradient-descent; batch fits all windows at once, off-line.",
    ),
]
BodyForce = Annotated[
    ForceFrame | None,
    typer.Option(
        "--body-force",
        show_default=False,
        help="Also learn a force beside slip: fixed to the robot (body: a towed load, a stuck wheel) or to "
        "the map (world: wind). Settings: [body_force].",
    ),
]
SettingsFile = Annotated[Path | None, optional("FILE.toml", "Settings of learning.", "--settings")]
Report = Annotated[Path | None, optional("FILE.html", "Write the HTML report to this file.")]
Json = Annotated[
    Path | None, optional("FILE", "Write the result as JSON; `-` prints it instead of tables.", "--json")
]
Folder = Annotated[
    Path | None, optional("DIR", "Write here, not into a new folder below `runs`.", "-o", "--output")
]
ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", show_default=False, help="A model file (.yaml).")]
Labels = Annotated[
    list[str] | None,
    optional(
        "LABEL",
        "With --memory: the surface of all logs, or given once for each, or a table (.csv) of labels by run "
        "and time as `slipwise terrain classify` writes it; else the column `terrain` says it.",
        "--terrain",
    ),
]
Duration = Annotated[float, typer.Option(metavar="SECONDS", help="How long to drive.")]
Seed = Annotated[int, typer.Option(metavar="N", help="Of the drive and of the pose noise.")]
Runs = Annotated[Path, typer.Option(metavar="DIR", help="Where run folders are kept.")]

_LOG_OPTIONS: dict[str, tuple[Any, str, str]] = {
    "pose_topic": (
        list[str],
        "TOPIC",
        "Measured pose: Odometry, Pose[WithCovariance]Stamped, NavSatFix, TFMessage. Again for others.",
    ),
    "command_topic": (
        str,
        "TOPIC",
        "Commands: Twist, TwistStamped, AckermannDriveStamped; none: do not read any.",
    ),
    "wheel_topic": (
        str,
        "TOPIC",
        "Wheel odometry: Odometry (its twist) or JointState; none: do not read any.",
    ),
    "imu_topic": (
        str,
        "TOPIC",
        "Imu: orientation or yaw rate beside a NavSatFix, tilt beside poses; alone with --pose-topic none.",
    ),
    "pose_frame": (str, "FRAME", "TF: the fixed frame, such as map."),
    "child_frame": (str, "FRAME", "TF: the robot's frame, such as base_link."),
    "left_joints": (str, "NAMES", "JointState: left wheels, separated by commas."),
    "right_joints": (str, "NAMES", "JointState: right wheels, separated by commas."),
    "wheel_radius": (float, "METRES", "Wheel radius, for wheel speeds in rad/s."),
    "wheel_separation": (
        float,
        "METRES",
        "Distance between left and right wheels, for wheel speeds in rad/s.",
    ),
    "wheelbase": (float, "METRES", "Distance between the axles, for steering angles."),
    "vehicle": (str, "NAME", "What the robot drives on: a preset such as husky, or a .yaml file."),
    "command_scale": (
        str,
        "V,OMEGA",
        "Factors of the commanded speed and yaw rate: 0.15,1 for rad/s of 0.15 m wheels; -1,1 for a sign.",
    ),
    "wheel_scale": (str, "V,OMEGA", "The same factors for the speed and yaw rate of the wheels."),
    "pose_yaw_offset": (
        float,
        "RADIANS",
        "Added to the heading of every pose: 3.1416 if the pose sensor looks backwards.",
    ),
    "most_unpacked": (float, "MIB", "What a compressed table or chunk may unpack to; default 512."),
    "most_fetched": (float, "MIB", "What a log on a server may have; default 4096."),
    "poses": (
        list[Path],
        "FILE",
        "Measured poses in a file beside the log: TUM, KITTI, a table, GPX, NMEA, .pos. Again for others.",
    ),
    "pose_clock_offset": (
        str,
        "SECONDS",
        "Added to the stamps of the poses; `auto` finds it from the motion that inputs and poses share.",
    ),
    "command_timeout": (
        float,
        "SECONDS",
        "The robot's watchdog ends a command that is not repeated for so long; default: it is held.",
    ),
    "start": (float, "SECONDS", "Leave out what is before, counted from the log's start."),
    "end": (float, "SECONDS", "Leave out what is after, counted from the log's start."),
    "columns": (
        str,
        "NAMES",
        "Columns of a table under other names, such as t=time,cmd_v=vx, or by number from 0: t=0,cmd_v=1.",
    ),
}
_FACTORS = ("command_scale", "wheel_scale")


def takes_log_options(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command with a parameter `log_options` one option for each field of LogOptions.

    A command's own option of that name goes before: `slipwise live --vehicle` says whose model it is.
    """
    unloaded = {"LogOptions": object}  # its module is heavy, and its type is never looked at
    signature = inspect.signature(command, eval_str=True, locals=unloaded)
    own = [parameter for parameter in signature.parameters.values() if parameter.name != "log_options"]
    names = _LOG_OPTIONS.keys() - {parameter.name for parameter in own}
    added = [_parameter(name, *about) for name, about in _LOG_OPTIONS.items() if name in names]

    @functools.wraps(command)
    def wrapper(**given: Any) -> int:
        options = _log_options({name: given.pop(name) for name in names}, given.get("settings"))
        return command(log_options=options, **given)

    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in (*own, *added)]
    wrapper.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    wrapper.__annotations__ = {p.name: p.annotation for p in parameters}
    return wrapper


def chosen_settings(
    file: Path | None, basis: str | None, estimator: str | None = None, body_force: str | None = None
) -> Settings:
    """Return the settings of a file, or the defaults, with what is given replaced.

    Raises:
        SettingsError: the file, the basis, the estimator or the frame of a force is wrong.
    """
    from slipwise.calibration import Settings, load_settings

    settings = (load_settings(file) if file is not None else Settings()).choosing(
        basis, estimator, body_force
    )
    settings.bases()
    return settings


def _parameter(name: str, kind: Any, metavar: str, text: str) -> inspect.Parameter:
    option = typer.Option(
        f"--{name.replace('_', '-')}", metavar=metavar, help=text, show_default=False, rich_help_panel="Log"
    )
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[kind | None, option]
    )


def _log_options(given: dict[str, Any], settings: Path | None) -> LogOptions:
    """Return the options of the command line, and for the others those of the settings file."""
    from slipwise.logs import LogOptions
    from slipwise.logs.column_names import parse_columns

    chosen: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    for name, further in (("poses", "other_poses"), ("pose_topic", "other_pose_topics")):
        if name in chosen:
            chosen[name], *others = chosen[name]
            chosen |= {further: tuple(others)} if others else {}
    for name in ("left_joints", "right_joints"):
        if name in chosen:
            chosen[name] = tuple(part for part in chosen[name].split(",") if part)
    if "columns" in chosen:
        chosen["columns"] = parse_columns(chosen["columns"])
    if "pose_clock_offset" in chosen:
        chosen["pose_clock_offset"] = _seconds_or_auto(chosen["pose_clock_offset"])
    for name in _FACTORS:
        if name in chosen:
            chosen[name] = _factors(name, chosen[name])
    if settings is None:
        return LogOptions(**chosen)
    from slipwise.calibration import load_settings

    return load_settings(settings).log_options(**chosen)


def _factors(name: str, text: str) -> tuple[float, ...]:
    from slipwise.errors import SettingsError

    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise SettingsError(
            f"'{text}' is no two factors, of speed and yaw rate",
            where=f"--{name.replace('_', '-')}",
            advice="such as 0.15,1 or -1,1",
        ) from None


def _seconds_or_auto(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text  # LogOptions knows what else it may be
