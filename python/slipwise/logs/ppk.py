# SPDX-License-Identifier: Apache-2.0
"""Reads positions that RTKLIB solved afterwards (PPK): .pos files with latitude, longitude and height."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Floats
from slipwise.logs.navsat import east_north_up
from slipwise.logs.streams import RawStream

LEAP_SECONDS = 18  # GPS time is this far ahead of UTC since 2017
_GPS_START = datetime(1980, 1, 6, tzinfo=UTC)
_WEEK = 604_800.0  # [s]
_USABLE = (1, 2)  # quality: fixed and float ambiguities; the rest is metres off
_SETTINGS = "let RTKLIB write `lat/lon/height` in degrees, with GPST or UTC"


def is_ppk(text: str) -> bool:
    """Say whether a text file starts like an RTKLIB solution."""
    return text.startswith("%") and any(system in text[:20_000] for system in ("GPST", "UTC", "JST"))


def read_ppk(path: Path, text: str, tally: Tally) -> tuple[RawStream, tuple[str, ...]]:
    """Return positions [m] in the tangent plane at the first solution, stamped in UTC, without headings.

    Raises:
        LogError: the solutions are not of latitude, longitude and height in degrees.
    """
    lines = text.splitlines()
    header = next((line for line in lines if line.startswith("%") and "Q" in line.split()), "")
    if "latitude(deg)" not in header or "JST" in header:
        raise LogError("not solutions in degrees", where=str(path), advice=_SETTINGS)
    rows, numbers, broken, poor = [], [], [], []

    def place(line: int) -> str:
        return f"{path.name}, line {line}"

    for number, line in enumerate(lines, start=1):
        fields = line.replace(",", " ").split()
        if not fields or line.startswith("%"):
            continue
        row = _solution(fields)
        if row is None:
            broken.append(number)
        elif row[4] not in _USABLE:
            poor.append(number)
        else:
            rows.append(row)
            numbers.append(number)
    for lost, kind, reason in (
        (broken, "broken-row", "lines that are no solution"),
        (poor, "poor-fix", "solutions without fixed or float ambiguities (Q other than 1 and 2)"),
    ):
        tally.add_lines(kind, f"{path.name}: {reason}", lost, place)
    values = np.array(rows, dtype=np.float64).reshape(-1, 6)
    leap = 0 if "UTC" in header else LEAP_SECONDS
    notes = (f"{path.name}: GPS time, {leap} s ahead of UTC, was turned into UTC",) if leap else ()
    found = np.array(numbers, dtype=np.int64)
    optional = frozenset(("z", "std_xy"))
    return RawStream("poses", values[:, 0] - leap, _columns(values), found, place, optional), notes


def _columns(values: Floats) -> dict[str, Floats]:
    places = east_north_up(*values[:, 1:4].T) if len(values) else np.empty((0, 3))
    return {"x": places[:, 0], "y": places[:, 1], "z": places[:, 2], "std_xy": values[:, 5]}


def _solution(fields: list[str]) -> tuple[float, ...] | None:
    """Return (s since 1970 in the file's time, latitude, longitude, height, quality, std), None if broken."""
    try:
        day, clock = fields[:2]
        if "/" in day:
            moment = datetime.strptime(f"{day} {clock}"[:26], "%Y/%m/%d %H:%M:%S.%f")  # noqa: DTZ007
            seconds = moment.replace(tzinfo=UTC).timestamp()
        else:
            since = timedelta(seconds=int(day) * _WEEK + float(clock))
            seconds = (_GPS_START + since).timestamp()
        latitude, longitude, height = (float(field) for field in fields[2:5])
        quality = int(fields[5])
        north, east = (float(field) for field in fields[7:9])
    except (ValueError, OverflowError, IndexError):
        return None
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 360.0 and abs(height) < 1e5):
        return None
    return seconds, latitude, longitude, height, quality, float(np.sqrt(0.5 * (north**2 + east**2)))
