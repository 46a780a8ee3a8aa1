# SPDX-License-Identifier: Apache-2.0
"""Finds out before the work, not after it, whether its results can be written."""

from __future__ import annotations

import errno
import os
import tempfile
from pathlib import Path

from slipwise.errors import OutputError
from slipwise.files import output_errors

LOG_ENDINGS = (".csv", ".csv.gz", ".parquet", ".mcap")


def refuse_unwritable(*paths: Path | None) -> None:
    """Raise where one of the files could not be written; nothing is left behind.

    Raises:
        OutputError: a path is a folder, or a device or pipe that a file would replace; or its folder is
            read-only, full, or below a file.
    """
    for path in paths:
        if path is None:
            continue
        with output_errors(path):
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
            if path.exists() and not path.is_file():
                raise OutputError(
                    "not a file", where=str(path), advice="name a file, or use `--json -` to print"
                )
            with tempfile.TemporaryFile(dir=_existing(path.absolute().parent)):
                pass


def refuse_unknown_log_format(path: Path) -> None:
    """Raise where a log cannot be written under this name.

    Raises:
        OutputError: the ending says no known format.
    """
    if not path.name.endswith(LOG_ENDINGS):
        raise OutputError(
            "unknown kind of log file", where=str(path), advice=f"end the name in {', '.join(LOG_ENDINGS)}"
        )


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that is there."""
    while not os.path.lexists(folder):
        folder = folder.parent
    return folder
