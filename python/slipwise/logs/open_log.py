# SPDX-License-Identifier: Apache-2.0
"""Opens logs of any kind: `open_log` looks at what a file holds and calls the reader for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from slipwise.errors import LogError
from slipwise.files import refuse_irregular
from slipwise.logs.log import Log
from slipwise.logs.options import LogOptions
from slipwise.logs.quality import checked
from slipwise.logs.run_name import run_name
from slipwise.logs.unpacking import unpacking_at_most

_KNOWN = "give a tidy CSV, CSV.gz or Parquet file, or a ROS bag (.mcap, .db3, .bag, or a rosbag2 folder)"

_GUESS = LogOptions()


def open_log(*paths: str | Path, options: LogOptions = _GUESS) -> Log:
    """Read one or several files as one log; runs of different files are never joined.

    Args:
        paths: tidy tables (CSV, CSV.gz, Parquet) and bags (rosbag1, rosbag2 folder or .db3, MCAP).
        options: what cannot be guessed.

    Raises:
        LogError: a file is missing, damaged, of an unknown kind, or says something impossible.
    """
    if not paths:
        raise LogError("no log was given", advice=_KNOWN)
    return _joined([_open_one(Path(path), options) for path in paths])


def _open_one(path: Path, options: LogOptions) -> Log:
    if "\0" in str(path) or not path.exists():
        raise LogError("no such file", where=str(path), advice="check the path")
    try:
        refuse_irregular(path, error=LogError)
        with unpacking_at_most(options.most_unpacked):
            return checked(_reader(path)(path, options))
    except PermissionError as error:
        raise LogError("no permission to read", where=str(path), advice="check the file's owner") from error


def _reader(path: Path) -> Callable[[Path, LogOptions], Log]:
    """Choose the reader by what the file holds; the readers are loaded only when they are needed."""
    from slipwise.logs.bag_file import is_bag

    if path.is_dir() or is_bag(path):
        from slipwise.logs.bag import read_bag

        return read_bag
    if path.stat().st_size == 0:
        raise LogError("the file is empty", where=str(path), advice="record or copy it again")
    if path.suffix in (".mcap", ".db3", ".bag"):
        advice = f"a {path.suffix} file starts otherwise; copy it again from the robot"
        raise LogError("not a bag: wrong magic bytes", where=str(path), advice=advice)
    from slipwise.logs.tidy import read_parquet_log, read_tidy

    with path.open("rb") as file:
        parquet = file.read(4) == b"PAR1"
    if path.suffix == ".parquet" and not parquet:
        raise LogError("not a Parquet file: wrong magic bytes", where=str(path), advice="write it again")
    return read_parquet_log if parquet else read_tidy


def _joined(logs: list[Log]) -> Log:
    if len(logs) == 1:
        return logs[0]
    names = Counter(name for log in logs for name in {run.name for run in log.runs})
    return Log(
        runs=tuple(
            replace(run, name=f"{label}/{run.name}") if names[run.name] > 1 else run
            for label, log in zip(_labels(logs), logs, strict=True)
            for run in log.runs
        ),
        sources=tuple(source for log in logs for source in log.sources),
        left_out=tuple(entry for log in logs for entry in log.left_out),
        notes=tuple(note for log in logs for note in log.notes),
    )


def _labels(logs: list[Log]) -> list[str]:
    """Return a name for each file; the file's own, numbered where it occurs twice."""
    stems = [run_name(Path(log.sources[0].path)) for log in logs]
    counted = Counter(stems)
    return [stem if counted[stem] == 1 else f"{number}-{stem}" for number, stem in enumerate(stems, start=1)]
