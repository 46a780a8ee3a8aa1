# SPDX-License-Identifier: Apache-2.0
"""Chooses commands, wheels and poses of a rover among the messages of ArduPilot."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slipwise.errors import SettingsError
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
