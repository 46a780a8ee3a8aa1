# SPDX-License-Identifier: Apache-2.0
"""Options that say nothing of a log of some kind: given for it alone they are refused."""

from __future__ import annotations

from slipwise.errors import SettingsError
from slipwise.log_fields import LOG_FIELDS
from slipwise.logs.log import Source
from slipwise.logs.options import LogOptions, RobotOptions

TABLE, LINES, BAG, ROS = "a table", "a stream of lines", "a bag", "a robot on ROS"
_DATAFLASH, _FLIGHT = "a log of ArduPilot", "a log of an autopilot"
_OF_FORMAT = {
    **dict.fromkeys(("mcap", "rosbag1", "rosbag2-sqlite3"), BAG),
    **dict.fromkeys(("tlog", "ulog"), _FLIGHT),
    "dataflash": _DATAFLASH,
}
_JOINTS = ("left_joints", "right_joints")
_BESIDE = ("command_topic", "wheel_topic", "imu_topic", "pose_frame", "child_frame", *_JOINTS)
_WHOLE = ("poses", "start", "end")  # what takes a whole log
_UNHEEDED = {
    TABLE: ("pose_topic", *_BESIDE),
    LINES: ("pose_topic", *_BESIDE, *_WHOLE),
    BAG: ("columns",),
    ROS: ("columns", *_WHOLE),
    _DATAFLASH: (*_BESIDE, "columns"),
    _FLIGHT: ("pose_topic", *_BESIDE, "columns"),
}
#: Names of all options that some kind has nothing of.
OF_SOME = frozenset(name for names in _UNHEEDED.values() for name in names)


def kind_of(source: Source) -> str:
    """Return of which kind a file is."""
    return _OF_FORMAT.get(source.format, TABLE)


def refuse_unheeded(options: LogOptions, *kinds: str) -> None:
    """Refuse options of which none of these kinds of logs has anything; settings of a robot may hold them.

    Raises:
        SettingsError: one was given, and would change nothing.
    """
    for about in () if isinstance(options, RobotOptions) else LOG_FIELDS:
        name = about.name
        unheeded = all(name in _UNHEEDED[kind] for kind in kinds)
        if not unheeded or getattr(options, name) == about.default or _of_another(name, options):
            continue
        advice = "leave it away"
        if name in _WHOLE:
            advice = "calibrate a recording with it"
        elif name == "pose_topic" and kinds[0] in (TABLE, LINES):
            advice = "leave it away; poses are x, y and yaw (--columns), a column source names their sources"
        elif kinds[0] in (TABLE, LINES):
            advice = "leave it away; --columns names columns"
        raise SettingsError(f"{kinds[0]} has nothing that it would choose", where=about.option, advice=advice)


def _of_another(name: str, options: LogOptions) -> bool:
    """Whether an option is the vehicle's, or of the file with poses."""
    return (name in _JOINTS and options.joints_described) or (name == "columns" and options.poses is not None)
