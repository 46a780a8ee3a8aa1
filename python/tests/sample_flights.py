# SPDX-License-Identifier: Apache-2.0
"""Logs of autopilots by their formats' specifications: a rover that drives and turns, north-east-down."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SPEED, RATE, SEPARATION, RADIUS = 1.0, 0.3, 0.5, 0.1  # m/s, rad/s clockwise, m, m
DEGREES = 180.0 / np.pi


@dataclass(frozen=True)
class Flight:
    """What the rover did; it starts at the origin, with its front to the north, and turns right."""

    t: Floats  # [N] s
    north: Floats
    east: Floats
    heading: Floats  # rad, from north, clockwise


def made_flight(seconds: float = 20.0, rate: float = 20.0) -> Flight:
    """Return a circle to the right."""
    t = 5.0 + np.arange(0.0, seconds, 1.0 / rate)
    heading = RATE * (t - t[0])
    radius = SPEED / RATE
    return Flight(t, radius * np.sin(heading), radius * (1.0 - np.cos(heading)), heading)


_FORMATS = {"Q": "Q", "f": "f", "B": "B", "L": "i", "N": "16s", "h": "h"}
_HEAD = b"\xa3\x95"


class DataFlash:
    """Writes DataFlash messages: FMT first, then what it describes."""

    def __init__(self) -> None:
        self.data = b""
        self._ids: dict[str, tuple[int, str]] = {}
        self._define(0x80, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 89)

    def _define(self, number: int, name: str, form: str, columns: str, length: int) -> None:
        self.data += _HEAD + struct.pack(
            "<BBB4s16s64s", 0x80, number, length, name.encode(), form.encode(), columns.encode()
        )

    def add(self, name: str, form: str, columns: str, *values: object) -> None:
        """Write one message; the first of its name writes what describes it."""
        packing = "<" + "".join(_FORMATS[letter] for letter in form)
        if name not in self._ids:
            self._ids[name] = (0x81 + len(self._ids), packing)
            self._define(self._ids[name][0], name, form, columns, 3 + struct.calcsize(packing))
        self.data += _HEAD + bytes([self._ids[name][0]]) + struct.pack(packing, *values)


def write_dataflash(path: Path, flight: Flight, *, rtk: bool = False) -> Path:
    """Write a rover's .bin: attitude, EKF3 of two cores, GPS, targets, wheel encoders and their places."""
    log = DataFlash()
    for name, value in (("WENC_POS_Y", -SEPARATION / 2), ("WENC2_POS_Y", SEPARATION / 2)):
        log.add("PARM", "QNf", "TimeUS,Name,Value", 0, name.encode(), value)
    for k, t in enumerate(flight.t.tolist()):
        us, yaw = round(t * 1e6), float(flight.heading[k] * DEGREES % 360.0)
        north, east = float(flight.north[k]), float(flight.east[k])
        log.add("ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw", us, 2.0, 3.0, yaw)
        for core in (0, 1):
            place = (north + 100.0 * core, east, -1.0)
            log.add("XKF1", "QBffffff", "TimeUS,C,Roll,Pitch,Yaw,PN,PE,PD", us, core, 2.0, 3.0, yaw, *place)
        latitude, longitude = 45.0 + north / 111_131.8, 7.0 + east / 78_846.8
        fix = (6 if rtk else 3, round(latitude * 1e7), round(longitude * 1e7), 100.0)
        log.add("GPS", "QBLLf", "TimeUS,Status,Lat,Lng,Alt", us, *fix)
        log.add("THR", "Qf", "TimeUS,DesSpeed", us, SPEED)
        log.add("STER", "Qf", "TimeUS,DesTurnRate", us + 1000, RATE * DEGREES)
        travelled = SPEED * (t - 5.0), RATE * SEPARATION / 2 * (t - 5.0)
        log.add(
            "WENC", "Qff", "TimeUS,Dist0,Dist1", us, travelled[0] + travelled[1], travelled[0] - travelled[1]
        )
    path.write_bytes(log.data)
    return path


def write_tlog(path: Path, flight: Flight, *, late: float = 1.6e9) -> Path:
    """Write a .tlog with pymavlink; its receiver's clock is `late` seconds ahead of the vehicle's."""
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    link, data = mavlink.MAVLink(None, srcSystem=1, srcComponent=1), b""
    for name, value in (("WENC_POS_Y", -SEPARATION / 2), ("WENC2_POS_Y", SEPARATION / 2)):
        message = link.param_value_encode(name.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32, 2, 0)
        data += struct.pack(">Q", round((5.0 + late) * 1e6)) + message.pack(link)
    for k, t in enumerate(flight.t.tolist()):
        ms, half = round(t * 1e3), SEPARATION / 2 * RATE * (t - 5.0)
        travelled = SPEED * (t - 5.0)
        messages = (
            link.attitude_encode(ms, 0.02, 0.03, float(flight.heading[k]), 0.0, 0.0, RATE),
            link.local_position_ned_encode(ms, float(flight.north[k]), float(flight.east[k]), -1.0, 0, 0, 0),
            link.wheel_distance_encode(round(t * 1e6), 2, [travelled + half, travelled - half] + [0.0] * 14),
            link.set_position_target_local_ned_encode(
                0, 1, 1, mavlink.MAV_FRAME_BODY_NED, 0b0101_1100_0111, 0, 0, 0, SPEED, 0, 0, 0, 0, 0, 0, RATE
            ),
        )
        for message in messages:
            data += struct.pack(">Q", round((t + late) * 1e6)) + message.pack(link)
    path.write_bytes(data)
    return path


class ULogWriter:
    """Writes a ULog: definitions, then data."""

    def __init__(self) -> None:
        self._definitions = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
        self._definitions += self._message(b"B", bytes(40))
        self._data: list[tuple[float, bytes]] = []
        self._subscriptions = b""
        self._topics: dict[str, tuple[int, str]] = {}

    @staticmethod
    def _message(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<H", len(content)) + kind + content

    def parameter(self, name: str, value: float) -> None:
        """Write a parameter."""
        key = f"float {name}".encode()
        self._definitions += self._message(b"P", bytes([len(key)]) + key + struct.pack("<f", value))

    def topic(self, name: str, fields: str, packing: str) -> None:
        """Define a topic, such as "float x;uint8_t n;"; each has a timestamp before these."""
        number = len(self._topics)
        self._topics[name] = (number, f"<Q{packing}")
        self._definitions += self._message(b"F", f"{name}:uint64_t timestamp;{fields}".encode())
        self._subscriptions += self._message(b"A", struct.pack("<BH", 0, number) + name.encode())

    def add(self, name: str, t: float, *values: object) -> None:
        """Write one message of a topic at a time [s]."""
        number, packing = self._topics[name]
        content = struct.pack("<H", number) + struct.pack(packing, round(t * 1e6), *values)
        self._data.append((t, self._message(b"D", content)))

    def write(self, path: Path) -> Path:
        """Write the file, with data in the order of time."""
        data = b"".join(content for _, content in sorted(self._data, key=lambda item: item[0]))
        path.write_bytes(self._definitions + self._subscriptions + data)
        return path


def write_ulog(path: Path, flight: Flight, *, manual: bool = False, reset_at: int = -1) -> Path:
    """Write a differential rover's .ulg; the estimator jumps by 5 m to the north at sample `reset_at`."""
    log = ULogWriter()
    log.parameter("RD_WHEEL_TRACK", SEPARATION)
    log.topic(
        "vehicle_local_position",
        "float x;float y;float z;float heading;float eph;bool xy_valid;uint8_t xy_reset_counter;",
        "fffffBB",
    )
    log.topic("vehicle_attitude", "float[4] q;", "ffff")
    log.topic("wheel_encoders", "float[2] wheel_speed;", "ff")
    log.topic("rover_speed_setpoint", "float speed_body_x;", "f")
    log.topic("rover_rate_setpoint", "float yaw_rate_setpoint;", "f")
    for k, t in enumerate(flight.t.tolist()):
        jumped = 0 <= reset_at <= k
        place = (float(flight.north[k]) + 5.0 * jumped, float(flight.east[k]), -1.0)
        log.add("vehicle_local_position", t, *place, float(flight.heading[k]), 0.2, True, int(jumped))
        half, tilt = flight.heading[k] / 2.0, 0.02
        q = np.array([np.cos(half), tilt * np.cos(half), tilt * np.sin(half), np.sin(half)])
        log.add("vehicle_attitude", t, *(q / np.linalg.norm(q)).tolist())
        wheels = ((SPEED + RATE * SEPARATION / 2) / RADIUS, (SPEED - RATE * SEPARATION / 2) / RADIUS)
        log.add("wheel_encoders", t, *wheels)
        if not manual:
            log.add("rover_speed_setpoint", t, SPEED)
            log.add("rover_rate_setpoint", t, RATE)
    return log.write(path)
