# SPDX-License-Identifier: Apache-2.0
"""Reads ArduPilot's logs (.bin, .tlog) with pymavlink, and chooses a rover's streams among the messages."""

from __future__ import annotations

import contextlib
import io
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.errors import LogError, SettingsError
from slipwise.extras import to_install
from slipwise.logs.flight_roles import (
    Columns,
    FlightMessages,
    FlightStream,
    FlightStreams,
    between,
    held,
    wheels_from_distances,
    yaw_from_heading,
)
from slipwise.logs.log import Floats
from slipwise.logs.navsat import east_north_up
from slipwise.logs.options import LogOptions

ESTIMATORS = ("XKF1", "NKF1")  # EKF3, EKF2
RTK_FIXED = 6  # GPS.Status
MOSTLY = 0.8  # share of fixes that are RTK-fixed, for the receiver to be preferred to the estimator
OFFSETS = ("WENC_POS_Y", "WENC2_POS_Y")  # [m] of the wheel encoders, to the right
BODY_FRAMES = (8.0, 9.0, 12.0)  # MAV_FRAME_BODY_NED, BODY_OFFSET_NED, BODY_FRD
NO_SPEED, NO_YAW_RATE = 0b1000, 0b1000_0000_0000  # bits of a type_mask: vx, yaw_rate are not given

#: Fields of DataFlash messages, in the units that pymavlink gives: s, m, degrees.
DATAFLASH_FIELDS: dict[str, tuple[str, ...]] = {
    "ATT": ("Roll", "Pitch", "Yaw"),
    "GPS": ("Status", "Lat", "Lng", "Alt"),
    "NKF1": ("Roll", "Pitch", "Yaw", "PN", "PE", "PD"),
    "STER": ("DesTurnRate",),
    "THR": ("DesSpeed",),
    "WENC": ("Dist0", "Dist1"),
    "XKF1": ("Roll", "Pitch", "Yaw", "PN", "PE", "PD"),
}
TLOG_FIELDS: dict[str, tuple[str, ...]] = {
    "ATTITUDE": ("roll", "pitch", "yaw"),
    "LOCAL_POSITION_NED": ("x", "y", "z"),
    "SET_POSITION_TARGET_LOCAL_NED": ("coordinate_frame", "type_mask", "vx", "vy", "yaw_rate"),
    "WHEEL_DISTANCE": ("count", "distance0", "distance1"),
}
_CORES = ("C", "I")  # which of several estimators, or receivers, a message is of
_SECONDS = {"TimeUS": 1e-6, "TimeMS": 1e-3, "time_boot_ms": 1e-3, "time_usec": 1e-6}
_COMMAND = "SET_POSITION_TARGET_LOCAL_NED"  # dated by its sender's clock, so by when it was received
_CLOCK = "ATTITUDE"  # says how far the receiver's clock is from the vehicle's


def dataflash_streams(messages: FlightMessages, options: LogOptions) -> FlightStreams:
    """Choose the streams of a DataFlash log; what is missing stays None, what was guessed is noted.

    Raises:
        SettingsError: poses are asked of a message that the log does not have.
    """
    topics, made = messages.topics, FlightStreams()
    speed, rate = topics.get("THR"), topics.get("STER")
    if speed is not None and rate is not None:
        stamps = np.union1d(speed["t"], rate["t"])
        omega = -np.radians(held(stamps, rate["t"], rate["DesTurnRate"]))
        columns = {"v": held(stamps, speed["t"], speed["DesSpeed"]), "omega": omega}
        made.commands = FlightStream("THR, STER", stamps, columns)
        made.notes.append(
            "commands are what ArduPilot's controllers were to hold: THR.DesSpeed and STER.DesTurnRate; in "
            "modes without them (Manual, Hold) they say nothing"
        )
    made.wheels = _wheels("WENC", ("Dist0", "Dist1"), messages, options, made.notes)
    made.poses = _dataflash_poses(topics, options, made.notes)
    return made


def tlog_streams(messages: FlightMessages, options: LogOptions) -> FlightStreams:
    """Choose the streams of a telemetry log; what is missing stays None, what was guessed is noted."""
    topics, made = messages.topics, FlightStreams()
    command = topics.get("SET_POSITION_TARGET_LOCAL_NED")
    if command is not None:
        made.commands = _targets(command, made.notes)
    made.wheels = _wheels("WHEEL_DISTANCE", ("distance0", "distance1"), messages, options, made.notes)
    poses, attitude = topics.get("LOCAL_POSITION_NED"), topics.get("ATTITUDE")
    if poses is not None and attitude is not None:
        columns = _attitude_at(poses["t"], attitude, ("roll", "pitch", "yaw"), degrees=False)
        columns |= {"x": poses["y"], "y": poses["x"], "z": -poses["z"]}
        made.poses = FlightStream("LOCAL_POSITION_NED", poses["t"], columns)
        made.notes.append("poses are those of the estimator: LOCAL_POSITION_NED, with yaw of ATTITUDE")
    return made


def _targets(command: Columns, notes: list[str]) -> FlightStream | None:
    mask = command["type_mask"].astype(np.int64)
    given = (
        np.isin(command["coordinate_frame"], BODY_FRAMES) & (mask & NO_SPEED == 0) & (mask & NO_YAW_RATE == 0)
    )
    if not given.any():
        notes.append("SET_POSITION_TARGET_LOCAL_NED is not used: it gives no speed and yaw rate of the body")
        return None
    notes.append("commands are SET_POSITION_TARGET_LOCAL_NED, dated by when they were received or sent here")
    columns = {"v": command["vx"][given], "omega": -command["yaw_rate"][given]}
    return FlightStream("SET_POSITION_TARGET_LOCAL_NED", command["t"][given], columns)


def _wheels(
    topic: str, names: tuple[str, str], messages: FlightMessages, options: LogOptions, notes: list[str]
) -> FlightStream | None:
    """Make the wheels' twist; which wheel is the left one, and how far apart they are, the parameters say."""
    columns = messages.topics.get(topic)
    if columns is None:
        return None
    first, second = (messages.parameters.get(name, 0.0) for name in OFFSETS)
    separation = options.wheel_separation or abs(first - second)
    if not separation > 0.0:
        notes.append(f"{topic} is not used: give --wheel-separation, or set {' and '.join(OFFSETS)}")
        return None
    left, right = names if first <= second else names[::-1]
    known = f"{OFFSETS[0]} and {OFFSETS[1]}" if first != second else "guess: the first is the left one"
    notes.append(f"wheels are {topic}, {separation:g} m apart; which is the left one is known by {known}")
    return wheels_from_distances(topic, columns["t"], columns[left], columns[right], separation)


def _dataflash_poses(
    topics: Mapping[str, Columns], options: LogOptions, notes: list[str]
) -> FlightStream | None:
    attitude, fixes = topics.get("ATT"), topics.get("GPS")
    known = [
        name for name in (*ESTIMATORS, "GPS") if name in topics and (name != "GPS" or attitude is not None)
    ]
    wanted = options.pose_topic
    if wanted is not None and wanted not in known:
        raise SettingsError(
            f"no poses in {wanted}", where="--pose-topic", advice=f"one of {', '.join(known) or 'none'}"
        )
    good = fixes is not None and float((fixes["Status"] >= RTK_FIXED).mean()) >= MOSTLY
    chosen = wanted or ("GPS" if good and "GPS" in known else next(iter(known), None))
    if chosen is None:
        return None
    if chosen == "GPS" and fixes is not None and attitude is not None:
        notes.append("poses are GPS, RTK-fixed, of the antenna, with yaw of ATT; x is east, y north")
        return _fixes(fixes, attitude, rtk=good)
    notes.append(f"poses are those of the estimator ({chosen}), which uses what it fuses; x is east, y north")
    topic = topics[chosen]
    columns = _attitude_at(topic["t"], topic, ("Roll", "Pitch", "Yaw"), degrees=True)
    return FlightStream(chosen, topic["t"], columns | {"x": topic["PE"], "y": topic["PN"], "z": -topic["PD"]})


def _fixes(fixes: Columns, attitude: Columns, *, rtk: bool) -> FlightStream:
    columns = _attitude_at(fixes["t"], attitude, ("Roll", "Pitch", "Yaw"), degrees=True)
    good = fixes["Status"] >= (RTK_FIXED if rtk else 3)
    place = np.full((len(good), 3), np.nan)
    if good.any():
        place[good] = east_north_up(fixes["Lat"][good], fixes["Lng"][good], fixes["Alt"][good])
    return FlightStream("GPS", fixes["t"], columns | dict(zip("xyz", place.T, strict=True)))


def _attitude_at(
    t: Floats, attitude: Columns, names: tuple[str, str, str], *, degrees: bool
) -> dict[str, Floats]:
    """Return roll, pitch and yaw with y to the left and z up, at times [N] in s."""
    factor = np.pi / 180.0 if degrees else 1.0
    roll, pitch, yaw = (between(t, attitude["t"], attitude[name] * factor) for name in names)
    return {"roll": roll, "pitch": -pitch, "yaw": yaw_from_heading(yaw)}


def read_dataflash(path: Path) -> FlightMessages:
    """Read a DataFlash log; where there are several estimators or receivers, the first.

    Raises:
        LogError: it is damaged, or pymavlink is not installed.
    """
    with _reading(path):
        from pymavlink.DFReader import DFReader_binary

        class Reader(DFReader_binary):  # type: ignore[misc]
            """Ends at a message that says that it has no length, which pymavlink reads for ever."""

            def _parse_next(self) -> Any:
                begin = self.offset
                message = super()._parse_next()
                if message is not None and self.offset <= begin:
                    raise EOFError(f"a message without length at byte {begin}")
                return message

        log = Reader(str(path))
        try:
            return _collected("dataflash", log, DATAFLASH_FIELDS, ("PARM", "Name", "Value"))
        finally:
            log.close()


def read_tlog(path: Path) -> FlightMessages:
    """Read a telemetry log; times are the vehicle's, those of commands are shifted to them.

    Raises:
        LogError: it is damaged, or pymavlink is not installed.
    """
    with _reading(path):
        from pymavlink import mavutil

        log = mavutil.mavlogfile(str(path), robust_parsing=True)
        try:
            return _collected("tlog", log, TLOG_FIELDS, ("PARAM_VALUE", "param_id", "param_value"))
        finally:
            log.close()


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Name the file in whatever the library raises, and keep what it prints from the terminal."""
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            yield
    except ImportError as error:
        advice = to_install("mavlink")
        raise LogError("pymavlink is not installed", where=str(path), advice=advice) from error
    except Exception as error:  # damaged bytes make the library raise anything
        reason = f"{type(error).__name__} {error}"[:200]
        raise LogError(
            f"not a readable log: {reason}", where=str(path), advice="copy it again from the vehicle"
        ) from error


def _collected(
    kind: str, log: Any, fields: Mapping[str, tuple[str, ...]], parameter: tuple[str, str, str]
) -> FlightMessages:
    """Read all messages once: the fields of those that are known, and the parameters."""
    rows: dict[str, list[list[float]]] = {name: [] for name in fields}
    parameters: dict[str, float] = {}
    apart: list[float] = []
    while (message := log.recv_match(type=[*fields, parameter[0]])) is not None:
        name, content = message.get_type(), message.to_dict()
        if name == parameter[0]:
            parameters[str(content.get(parameter[1]))] = _number(content.get(parameter[2]))
            continue
        if any(content.get(core) not in (0, None) for core in _CORES):
            continue
        seconds = float(log.timestamp) if name == _COMMAND else _seconds(content)
        if name == _CLOCK:
            apart.append(float(log.timestamp) - seconds)
        distances = content.get("distance", ())
        content |= {f"distance{k}": value for k, value in enumerate(distances)}
        rows[name].append([seconds, *(_number(content.get(field)) for field in fields[name])])
    shift = float(np.median(apart)) if apart else 0.0
    topics = {}
    for name, found in rows.items():
        if found:
            columns = np.array(found, dtype=np.float64).T.copy()
            columns[0] -= shift if name == _COMMAND else 0.0
            topics[name] = dict(zip(("t", *fields[name]), columns, strict=True))
    return FlightMessages(kind, topics, parameters)


def _seconds(content: Mapping[str, Any]) -> float:
    """Return when a message was made, on the vehicle's clock; NaN where it does not say."""
    for name, factor in _SECONDS.items():
        if name in content:
            return _number(content[name]) * factor
    return math.nan


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan
