# SPDX-License-Identifier: Apache-2.0
"""Reads ArduPilot's DataFlash logs (.bin) and telemetry logs (.tlog) with pymavlink."""

from __future__ import annotations

import contextlib
import io
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.extras import to_install
from slipwise.logs.flight_roles import FlightMessages

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
