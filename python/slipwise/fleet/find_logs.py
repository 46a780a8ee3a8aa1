# SPDX-License-Identifier: Apache-2.0
"""The logs of a fleet, found in folders and by patterns, each with the vehicle that drove it."""

from __future__ import annotations

import glob
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slipwise.errors import LogError

ENDINGS = (".csv", ".csv.gz", ".parquet", ".mcap", ".db3", ".bag")
ROSBAG2 = "metadata.yaml"  # in a folder that is one log
OWN_VEHICLE = "unknown"  # of a log that lies in no named folder


@dataclass(frozen=True)
class LogTask:
    """One log to learn, as it crosses to a worker."""

    path: str
    vehicle: str
    settings: str  # TOML file, empty for the defaults
    log_sha256: str  # of the log's bytes


def find_logs(places: Iterable[str | Path], *, vehicle: str = "") -> list[tuple[Path, str]]:
    """Return every log below some folders, or that patterns such as `runs/*.mcap` match, with its vehicle.

    The vehicle is the name of the folder that the log lies in, where none is given for all.

    Raises:
        LogError: a place does not exist, or there is no log at all.
    """
    found: dict[Path, str] = {}
    for place in places:
        for path in _matches(str(place)):
            for log in _logs_in(path):
                found.setdefault(log, vehicle or log.absolute().parent.name or OWN_VEHICLE)
    if not found:
        raise LogError("there is no log there", where=", ".join(map(str, places)), advice=f"of {ENDINGS}")
    return sorted(found.items())


def _matches(place: str) -> list[Path]:
    path = Path(place)
    if path.exists():
        return [path]
    named = glob.glob(place, recursive=True)  # noqa: PTH207 - patterns may be absolute
    matched = [Path(name) for name in sorted(named)]
    if not matched:
        raise LogError("no such file or folder", where=place, advice="check the path or the pattern")
    return matched


def _logs_in(path: Path) -> list[Path]:
    if path.is_file() or (path / ROSBAG2).is_file():
        return [path]
    logs: list[Path] = []
    for inside in sorted(path.iterdir()):
        if inside.name.startswith("."):
            continue
        if inside.is_dir():
            logs.extend(_logs_in(inside))
        elif inside.name.endswith(ENDINGS):
            logs.append(inside)
    return logs
