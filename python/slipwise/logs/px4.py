# SPDX-License-Identifier: Apache-2.0
"""Reads PX4's logs (.ulg) with pyulog, and chooses commands, wheels and poses of a rover among the topics."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.extras import to_install
from slipwise.logs.flight_roles import (
    Columns,
    FlightMessages,
    FlightStream,
    FlightStreams,
    between,
    held,
    yaw_from_heading,
)
from slipwise.logs.kinematics import twist_from_wheels
from slipwise.logs.log import Floats
from slipwise.logs.options import LogOptions

#: Where the commanded speed stands, newest version of PX4 first.
SPEEDS = (
    ("rover_speed_setpoint", "speed_body_x"),
    ("rover_velocity_setpoint", "speed"),
    ("rover_differential_setpoint", "speed"),
    ("rover_differential_setpoint", "forward_speed_setpoint"),
)
YAW_RATES = (
    ("rover_rate_setpoint", "yaw_rate_setpoint"),
    ("rover_differential_setpoint", "yaw_rate"),
    ("rover_differential_setpoint", "yaw_rate_setpoint"),
)
POSES, ATTITUDE, WHEELS = "vehicle_local_position", "vehicle_attitude", "wheel_encoders"
TRACK = "RD_WHEEL_TRACK"  # [m] parameter of differential rovers


#: The topics that say anything about a rover's motion; those of several versions of PX4.
TOPICS = (
    "rover_differential_setpoint",
    "rover_rate_setpoint",
    "rover_speed_setpoint",
    "rover_velocity_setpoint",
    "vehicle_attitude",
    "vehicle_local_position",
    "wheel_encoders",
)
MOST_RETURNS = 10_000  # to places that were passed before


def px4_streams(messages: FlightMessages, options: LogOptions) -> FlightStreams:
    """Choose the streams; what is missing stays None, and what was guessed is noted."""
    made = FlightStreams()
    made.commands = _commands(messages, made.notes)
    made.wheels = _wheels(messages, options, made.notes)
    topic = messages.topics.get(POSES)
    if topic is not None:
        lacking = [name for name in ("x", "y", "z") if name not in topic]
        lacking += [] if {"heading", "yaw"} & set(topic) else ["heading"]
        if lacking:
            made.notes.append(f"{POSES} is not used: it has no {', '.join(lacking)}")
        else:
            made.poses = _poses(topic, messages.topics.get(ATTITUDE), made.notes)
    return made


def _found(messages: FlightMessages, names: tuple[tuple[str, str], ...]) -> tuple[str, Floats, Floats] | None:
    """Return the first topic that has a finite value of the field, with its stamps and values."""
    for topic, field in names:
        columns = messages.topics.get(topic, {})
        if field in columns and np.isfinite(columns[field]).any():
            return topic, columns["t"], columns[field]
    return None


def _commands(messages: FlightMessages, notes: list[str]) -> FlightStream | None:
    speed, rate = _found(messages, SPEEDS), _found(messages, YAW_RATES)
    if speed is None or rate is None:
        missing = "speed" if speed is None else "yaw rate"
        notes.append(f"no commands: the log has no setpoint of {missing}, as where a pilot drives directly")
        return None
    notes.append(f"commands are PX4's setpoints: speed of {speed[0]}, yaw rate of {rate[0]}")
    stamps = np.union1d(speed[1], rate[1])
    columns = {"v": held(stamps, *speed[1:]), "omega": -held(stamps, *rate[1:])}
    return FlightStream(f"{speed[0]}, {rate[0]}", stamps, columns)


def _wheels(messages: FlightMessages, options: LogOptions, notes: list[str]) -> FlightStream | None:
    topic = messages.topics.get(WHEELS)
    if topic is None or not {"wheel_speed[0]", "wheel_speed[1]"} <= set(topic):
        return None
    separation = options.wheel_separation or messages.parameters.get(TRACK, 0.0)
    if options.wheel_radius is None or not separation > 0.0:
        notes.append(f"{WHEELS} is not used: give --wheel-radius and --wheel-separation in metres")
        return None
    if options.wheel_separation is None:
        notes.append(f"the distance of the wheels is the parameter {TRACK}, {separation:g} m")
    notes.append(f"{WHEELS}: 0 is taken to be the left wheel, 1 the right one, in rad/s")
    v, omega = twist_from_wheels(
        topic["wheel_speed[0]"],
        topic["wheel_speed[1]"],
        wheel_radius=options.wheel_radius,
        wheel_separation=separation,
    )
    return FlightStream(WHEELS, topic["t"], {"v": v, "omega": omega})


def _poses(topic: Columns, attitude: Columns | None, notes: list[str]) -> FlightStream:
    """Make poses east-north-up; where the estimator jumps by a reset, a new frame begins."""
    t = topic["t"]
    count = len(t)
    valid = topic.get("xy_valid", np.ones(count)) > 0.0
    columns: dict[str, Floats] = {
        "x": np.where(valid, topic["y"], np.nan),
        "y": np.where(valid, topic["x"], np.nan),
        "yaw": yaw_from_heading(topic["heading"] if "heading" in topic else topic["yaw"]),
        "z": -topic["z"],
    }
    resets = [topic[name] for name in ("xy_reset_counter", "heading_reset_counter") if name in topic]
    columns["frame"] = (
        np.cumsum([np.diff(each, prepend=each[:1]) != 0.0 for each in resets], axis=1).sum(
            axis=0, dtype=np.float64
        )
        if resets
        else np.zeros(count)
    )
    if "eph" in topic:
        columns["std_xy"] = topic["eph"] / np.sqrt(2.0)
    if attitude is not None and {f"q[{k}]" for k in range(4)} <= set(attitude):
        w, x, y, z = (attitude[f"q[{k}]"] for k in range(4))
        roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
        pitch = -np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
        columns |= {"roll": between(t, attitude["t"], roll), "pitch": between(t, attitude["t"], pitch)}
    notes.append(
        f"poses are those of PX4's estimator ({POSES}), which uses what it fuses; x is east, y north"
    )
    return FlightStream(POSES, t, columns)


def read_ulog(path: Path) -> FlightMessages:
    """Read a ULog; where a topic has several instances, the first.

    Raises:
        LogError: it is damaged, or pyulog is not installed.
    """
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            from pyulog import ULog

            with _Forward(io.FileIO(path)) as file:
                log = ULog(file, message_name_filter_list=list(TOPICS))
            topics = {item.name: _columns(item) for item in log.data_list if item.multi_id == 0}
            parameters = {str(name): float(value) for name, value in log.initial_parameters.items()}
    except ImportError as error:
        raise LogError("pyulog is not installed", where=str(path), advice=to_install("px4")) from error
    except Exception as error:  # damaged bytes make the library raise anything
        reason = f"{type(error).__name__} {error}"[:200]
        raise LogError(
            f"not a readable ULog: {reason}", where=str(path), advice="copy it again from the vehicle"
        ) from error
    return FlightMessages("ulog", {name: each for name, each in topics.items() if len(each["t"])}, parameters)


class _Forward(io.BufferedReader):
    """A file that allows no endless seek back, as pyulog does from the end of some damaged ones."""

    _farthest, _returns = -1, 0

    def seek(self, offset: int, whence: int = 0, /) -> int:
        """Go to a place as in any file.

        Raises:
            EOFError: the place was behind another one too often; pyulog takes many other errors for damage.
        """
        place = super().seek(offset, whence)
        self._returns += place <= self._farthest
        self._farthest = max(self._farthest, place)
        if self._returns > MOST_RETURNS:
            raise EOFError("the end of the file is damaged")
        return place


def _columns(item: Any) -> dict[str, Any]:
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in item.data.items()}
    return columns | {"t": columns["timestamp"] * 1e-6}
