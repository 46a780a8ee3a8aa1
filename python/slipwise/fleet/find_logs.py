# SPDX-License-Identifier: Apache-2.0
"""The logs of a fleet, found in folders, by patterns, on servers and in lists, each with its vehicle."""

from __future__ import annotations

import glob
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from slipwise.addresses import remote_url, shown
from slipwise.errors import LogError

ENDINGS = (".csv", ".csv.gz", ".parquet", ".mcap", ".db3", ".bag", ".bin", ".tlog", ".ulg")
ROSBAG2 = "metadata.yaml"  # in a folder that is one log
LIST = "@"  # before the name of a file that names one place a line
OWN_VEHICLE = "unknown"  # of a log that lies in no named folder


@dataclass(frozen=True)
class LogTask:
    """One log to learn, as it crosses to a worker."""

    path: str  # or its address on a server
    vehicle: str
    settings: str  # TOML file, empty for the defaults
    log_sha256: str  # of the log's bytes; of one on a server: of those learned before, or empty
    tag: str = ""  # of the version on a server that was learned before


def find_logs(places: Iterable[str | Path], *, vehicle: str = "") -> list[tuple[Path, str]]:
    """Return every log below some folders, or that patterns such as `runs/*.mcap` match, with its vehicle.

    An address (https://, s3://, gs://) is one log, and @FILE stands for the places that a file names, one a
    line. The vehicle is the name of the folder that the log lies in, where none is given for all.

    Raises:
        LogError: a place does not exist, or there is no log at all.
    """
    found: dict[Path, str] = {}
    for place in _listed(map(str, places)):
        if remote_url(place) is not None:
            found.setdefault(Path(place), vehicle or _folder_on_server(place))
            continue
        for path in _matches(place):
            for log in _logs_in(path, set()):
                found.setdefault(log, vehicle or log.absolute().parent.name or OWN_VEHICLE)
    if not found:
        raise LogError("there is no log there", where=", ".join(map(shown, places)), advice=f"of {ENDINGS}")
    return sorted(found.items())


def _listed(places: Iterable[str]) -> Iterator[str]:
    """Yield the places, and those of lists in place of these; empty lines and those with # say nothing."""
    for place in places:
        if not place.startswith(LIST) or Path(place).exists():
            yield place
            continue
        try:
            lines = Path(place.removeprefix(LIST)).read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as problem:
            raise LogError(
                "cannot read the list of logs", where=place, advice="name a text file, one place a line"
            ) from problem
        yield from (line.strip() for line in lines if line.strip() and not line.lstrip().startswith("#"))


def _folder_on_server(address: str) -> str:
    """Return the last folder of an address; the server's name is none."""
    folders = shown(address).split("/")[3:-1]
    return unquote(folders[-1]) if folders and folders[-1] else OWN_VEHICLE


def _matches(place: str) -> list[Path]:
    path = Path(place)
    if path.exists():
        return [path]
    named = glob.glob(place, recursive=True)  # noqa: PTH207 - patterns may be absolute
    matched = [Path(name) for name in sorted(named)]
    if not matched:
        raise LogError("no such file or folder", where=place, advice="check the path or the pattern")
    return matched


def _logs_in(path: Path, visited: set[Path]) -> list[Path]:
    """Return the logs below a folder, each real folder looked into once, however many links lead there."""
    if path.is_file() or (path / ROSBAG2).is_file():
        return [path]
    real = path.resolve()
    if real in visited:
        return []
    visited.add(real)
    logs: list[Path] = []
    for inside in sorted(path.iterdir()):
        if inside.name.startswith("."):
            continue
        if inside.is_dir():
            logs.extend(_logs_in(inside, visited))
        elif inside.name.endswith(ENDINGS):
            logs.append(inside)
    return logs
