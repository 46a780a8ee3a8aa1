# SPDX-License-Identifier: Apache-2.0
"""Reads fixes of NMEA 0183 sentences (GGA, or RMC where there are no GGA), as positions without headings."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import reduce
from pathlib import Path

from slipwise.logs.left_out import Tally
from slipwise.logs.satellite_track import Fix, track_stream
from slipwise.logs.streams import RawStream

_DAY = 86_400.0  # [s]
_STARTS = re.compile(r"\s*\$[A-Z]{2}(GGA|RMC),")
_SENTENCE = re.compile(r"\s*\$(?P<body>[A-Z]{2}(?:GGA|RMC),[^*$]*)\*(?P<sum>[0-9A-Fa-f]{2})\s*")
_CLOCK = re.compile(r"([01]\d|2[0-3])([0-5]\d)([0-5]\d(?:\.\d*)?)", re.ASCII)  # hhmmss.ss
_ANGLE = re.compile(r"(\d{1,3})([0-5]\d(?:\.\d*)?)", re.ASCII)  # dddmm.mmmm
_SIGNS = {"N": 1.0, "E": 1.0, "S": -1.0, "W": -1.0}
_QUALITIES = {1: "autonomous", 2: "differential", 3: "PPS", 4: "RTK fixed", 5: "RTK float", 8: "simulated"}
_NO_DATE = "the sentences have no date (RMC): stamps are seconds of the day; give --pose-clock-offset auto"

_Numbered = tuple[int, Fix | None]  # a fix with the number of its line


@dataclass
class _Track:
    """What was read so far."""

    day: float  # [s] since 1970 of the last midnight
    clock: float = -1.0  # [s] since midnight of the last fix
    gga: list[_Numbered] = field(default_factory=list)
    rmc: list[_Numbered] = field(default_factory=list)
    qualities: Counter[str] = field(default_factory=Counter)

    def at(self, clock: float) -> float:
        """Return a time [s since 1970]; a clock that starts again says that midnight has passed."""
        if clock < self.clock - 0.5 * _DAY:
            self.day += _DAY
        self.clock = clock
        return self.day + clock


def is_nmea(text: str) -> bool:
    """Say whether a text starts with sentences of a receiver."""
    return any(re.match(r"\s*\$[A-Z]{2}[A-Z]{3},", line) for line in text[:4000].splitlines()[:20])


def read_nmea(path: Path, text: str, tally: Tally) -> tuple[RawStream, tuple[str, ...]]:
    """Return the fixes, dated by RMC, in UTC.

    Sentences that are cut off or whose checksum is wrong, and fixes that a receiver did not measure (quality
    0, 6, 7; RMC's status V) are left out and counted. Heights are above the ellipsoid. (NMEA 0183, 4.10)
    """
    sentences = _sentences(path, text, tally)
    dates = [day for _, fields in sentences if fields[0][2:] == "RMC" and (day := _date(fields)) is not None]
    track = _Track(day=dates[0] if dates else 0.0)
    for number, fields in sentences:
        if fields[0][2:] == "RMC":
            day = _date(fields)
            if day is not None and day != track.day:
                track.day, track.clock = day, -1.0
            if not track.gga:
                track.rmc.append((number, _rmc(fields, day)))
        else:
            track.gga.append((number, _gga(fields, track)))
    fixes = track.gga or track.rmc
    notes = () if dates else (_NO_DATE,)
    if track.qualities:
        counts = ", ".join(f"{count} {name}" for name, count in track.qualities.most_common())
        notes = (*notes, f"fixes of {path.name}: {counts}")
    return track_stream(path, "line", fixes, tally), notes


def _sentences(path: Path, text: str, tally: Tally) -> list[tuple[int, list[str]]]:
    """Return the fields of each whole GGA and RMC with the number of its line."""
    sentences, cut, wrong = [], [], []
    for number, line in enumerate(text.splitlines(), start=1):
        match = _SENTENCE.fullmatch(line)
        if match is None:
            if _STARTS.match(line):
                cut.append(number)
        elif reduce(lambda a, b: a ^ ord(b), match["body"], 0) != int(match["sum"], 16):
            wrong.append(number)
        else:
            sentences.append((number, match["body"].split(",")))
    for lines, what in ((cut, "sentences that are cut off"), (wrong, "sentences with a wrong checksum")):
        tally.add_lines("broken-row", what, lines, lambda line: f"{path.name}, line {line}")
    return sentences


def _gga(fields: Sequence[str], track: _Track) -> Fix | None:
    try:
        quality = _QUALITIES[int(fields[6])]
        height = sum(float(fields[k]) for k in (9, 11)) if fields[9] and fields[11] else float("nan")
        latitude, longitude, clock = _angle(fields[2:4]), _angle(fields[4:6]), _clock(fields[1])
    except (KeyError, ValueError, IndexError):
        return None
    track.qualities[quality] += 1
    return track.at(clock), latitude, longitude, height


def _rmc(fields: Sequence[str], day: float | None) -> Fix | None:
    try:
        place = _angle(fields[3:5]), _angle(fields[5:7])
        return None if day is None else (day + _clock(fields[1]), *place, float("nan"))
    except (ValueError, IndexError):
        return None


def _date(fields: Sequence[str]) -> float | None:
    """Return the start of a day [s since 1970] by RMC, None where the receiver does not vouch for it."""
    try:
        day = datetime.strptime(fields[9], "%d%m%y").replace(tzinfo=UTC)
    except (ValueError, IndexError):
        return None
    return day.timestamp() if fields[2] == "A" else None


def _clock(text: str) -> float:
    """Return seconds since midnight.

    Raises:
        ValueError: it is no time of a day.
    """
    match = _CLOCK.fullmatch(text)
    if match is None:
        raise ValueError(text)
    return 3600.0 * int(match[1]) + 60.0 * int(match[2]) + float(match[3])


def _angle(fields: Sequence[str]) -> float:
    """Return degrees of `ddmm.mmm` and the letter of its half of the earth.

    Raises:
        ValueError: it is no angle.
    """
    text, half = fields
    match = _ANGLE.fullmatch(text)
    if match is None or half not in _SIGNS:
        raise ValueError(text)
    return _SIGNS[half] * (int(match[1]) + float(match[2]) / 60.0)
