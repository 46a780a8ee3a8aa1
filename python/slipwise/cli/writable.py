# SPDX-License-Identifier: Apache-2.0
"""Finds out before the work, not after it, whether its results can be written, and would destroy nothing."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterable, Sequence
from itertools import combinations
from pathlib import Path

from slipwise.errors import OutputError
from slipwise.files import output_errors, written_place

LOG_ENDINGS = (".csv", ".csv.gz", ".parquet", ".mcap")


def refuse_unwritable(*outputs: Path | None, inputs: Iterable[Path | None] = ()) -> None:
    """Raise where one of the files could not be written, or would replace what the command reads or writes.

    Nothing is left behind. Two names are of one file, whatever links and relative paths lead there.

    Args:
        outputs: the files that the command writes; None where it does not write one.
        inputs: the files and folders that it reads.

    Raises:
        OutputError: a path is a folder, or `-`, a device or pipe that a file would replace; its folder is
            read-only, full, or below a file; it is one of the inputs, or two outputs are one file.
    """
    named = [path for path in outputs if path is not None]
    for path in named:
        _refuse_unwritable(path)
    _refuse_destroying(named, [path for path in inputs if path is not None])


def refuse_unknown_log_format(path: Path) -> None:
    """Raise where a log cannot be written under this name.

    Raises:
        OutputError: the ending says no known format.
    """
    if not path.name.endswith(LOG_ENDINGS):
        raise OutputError(
            "unknown kind of log file", where=str(path), advice=f"end the name in {', '.join(LOG_ENDINGS)}"
        )


def _refuse_unwritable(path: Path) -> None:
    with output_errors(path):
        place = written_place(path)
        if place.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if str(path) == "-" or (place.exists() and not place.is_file()):
            raise OutputError("not a file", where=str(path), advice="name a file, or use `--json -` to print")
        with tempfile.TemporaryFile(dir=_existing(place.absolute().parent)):
            pass


def _refuse_destroying(outputs: Sequence[Path], inputs: Sequence[Path]) -> None:
    for path in outputs:
        for source in inputs:
            where = ""
            if _same_file(path, source):
                where = str(path) if path == source else f"{path}, which is {source}"
            elif _is_part_of(path, source):
                where = f"{path}, a part of {source}"
            if where:
                raise OutputError("this would replace what is read", where=where, advice="name another file")
    for first, second in combinations(outputs, 2):
        if _same_file(first, second):
            where = str(first) if first == second else f"{first} and {second}"
            raise OutputError("two results would be one file", where=where, advice="name two files")


def _same_file(first: Path, second: Path) -> bool:
    try:
        return first.samefile(second)
    except OSError:  # one is not there yet, or cannot be looked at
        return os.path.realpath(first) == os.path.realpath(second)


def _is_part_of(path: Path, folder: Path) -> bool:
    """Whether the path is a file that is there, in a folder that is read, such as a rosbag2."""
    if not folder.is_dir():
        return False
    return any(_same_file(path, inside) for inside in folder.iterdir())


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that is there."""
    while not os.path.lexists(folder):
        folder = folder.parent
    return folder
