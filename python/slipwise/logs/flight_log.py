# SPDX-License-Identifier: Apache-2.0
"""Reads logs of autopilots (ArduPilot's .bin and .tlog, PX4's .ulg) as logs of rovers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from slipwise.errors import LogError
from slipwise.files import sha256_of
from slipwise.logs.flight_roles import FlightMessages, FlightStream, FlightStreams
from slipwise.logs.left_out import Tally
from slipwise.logs.log import OPTIONAL_POSE_COLUMNS, Log, Run, Source, run_name
from slipwise.logs.options import LogOptions
from slipwise.logs.streams import RawStream, to_inputs, to_poses

DATAFLASH, TLOG, ULOG = "dataflash", "tlog", "ulog"
_ULOG = b"ULog\x01\x12\x35"
_DATAFLASH = b"\xa3\x95\x80"  # header of a message, and the number of FMT, which comes first
_TLOG_STARTS = (0xFE, 0xFD)  # MAVLink 1 and 2, after eight bytes of time
_LATEST_TLOG = 1 << 52  # [us] since 1970; more is no time


def flight_format(path: Path) -> str | None:
    """Say by its first bytes which log of an autopilot a file is, None where it is none."""
    with path.open("rb") as file:
        start = file.read(9)
    if start.startswith(_ULOG):
        return ULOG
    if start.startswith(_DATAFLASH):
        return DATAFLASH
    if len(start) == 9 and start[8] in _TLOG_STARTS and 0 < int.from_bytes(start[:8], "big") < _LATEST_TLOG:
        return TLOG
    return None


def read_flight_messages(path: Path, kind: str) -> FlightMessages:
    """Return the messages of a log that say anything about motion.

    Raises:
        LogError: the log is damaged, or the library that reads it is not installed.
    """
    if kind == ULOG:
        from slipwise.logs.px4 import read_ulog

        return read_ulog(path)
    if kind == DATAFLASH:
        from slipwise.logs.ardupilot import read_dataflash

        return read_dataflash(path)
    from slipwise.logs.ardupilot import read_tlog

    return read_tlog(path)


def flight_streams(messages: FlightMessages, options: LogOptions) -> FlightStreams:
    """Choose commands, wheels and poses among the messages."""
    from slipwise.logs.ardupilot import dataflash_streams, tlog_streams
    from slipwise.logs.px4 import px4_streams

    readers: dict[str, Callable[[FlightMessages, LogOptions], FlightStreams]] = {
        ULOG: px4_streams,
        DATAFLASH: dataflash_streams,
        TLOG: tlog_streams,
    }
    return readers[messages.kind](messages, options)


def read_flight_log(path: Path, options: LogOptions) -> Log:
    """Read the log of an autopilot as one run; x is east, y north, and yaw is counted from east.

    Args:
        path: the file.
        options: `pose_topic` names the message to take poses from; sizes of wheels.

    Raises:
        LogError: the log is damaged, the library that reads it is missing, or there is no pose.
    """
    kind = flight_format(path)
    if kind is None:
        raise LogError("not the log of an autopilot", where=str(path), advice="copy it again")
    messages, tally = read_flight_messages(path, kind), Tally()
    chosen = flight_streams(messages, options)
    if chosen.poses is None:
        names = ", ".join(sorted(messages.topics)) or "nothing that is known"
        advice = "log position and attitude on the vehicle"
        raise LogError(f"no poses: there is {names}", where=str(path), advice=advice)
    poses = _raw("poses", chosen.poses, path)
    commands = _raw("commands", chosen.commands, path) if chosen.commands else None
    wheels = _raw("wheels", chosen.wheels, path) if chosen.wheels else None
    run = Run(
        name=run_name(path),
        commands=to_inputs(commands, tally) if commands else None,
        wheels=to_inputs(wheels, tally) if wheels else None,
        poses=to_poses(poses, tally),
    )
    count = sum(len(columns["t"]) for columns in messages.topics.values())
    source = Source(str(path), sha256_of(path), kind, count)
    return Log((run,), (source,), tally.result(), tuple(chosen.notes))


def _raw(role: str, stream: FlightStream, path: Path) -> RawStream:
    place = f"{path.name}, {stream.topic} message"
    return RawStream(
        role,
        stream.t,
        dict(stream.columns),
        np.arange(len(stream.t)),
        lambda row: f"{place} {row + 1}",
        frozenset(OPTIONAL_POSE_COLUMNS),
    )
