# SPDX-License-Identifier: Apache-2.0
"""Logs that come through a pipe: kept in a temporary file, since a log is read more than once."""

from __future__ import annotations

import functools
import os
import re
import stat
import tempfile
from pathlib import Path

from slipwise.errors import LogError

LARGEST = 1 << 30  # [bytes] of a log through a pipe
_BLOCK = 1 << 20
_INHERITED = re.compile(r"/dev/std(in)|/(?:dev|proc/self)/fd/(\d+)")
_SAVE = "save it to a file and name that"


def regular_file(path: Path) -> Path:
    """Return the file itself, or for standard input and `<(...)` a copy of what comes through the pipe.

    Raises:
        LogError: it is a device, a socket or a named pipe, or too much comes through.
    """
    mode = path.stat().st_mode
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return path
    inherited = _INHERITED.fullmatch(str(path))
    if inherited is None:
        raise LogError("not a regular file", where=str(path), advice=_SAVE)
    if stat.S_ISCHR(mode):
        advice = "write `... | slipwise inspect /dev/stdin`, or name a file"
        raise LogError("nothing is piped in", where=str(path), advice=advice)
    descriptor = 0 if inherited[1] else int(inherited[2])
    return _copied(str(path), descriptor, os.fstat(descriptor).st_ino)


_folders: list[tempfile.TemporaryDirectory[str]] = []  # removed when the program ends


@functools.cache
def _copied(shown: str, descriptor: int, _inode: int) -> Path:
    """Copy a pipe once; it cannot be read again."""
    folder = tempfile.TemporaryDirectory(prefix="slipwise-")
    _folders.append(folder)
    copy = Path(folder.name) / ("stdin" if descriptor == 0 else "pipe")
    size = 0
    with os.fdopen(os.dup(descriptor), "rb") as pipe, copy.open("wb") as file:
        while block := pipe.read(_BLOCK):
            size += len(block)
            if size > LARGEST:
                what = f"more than {LARGEST >> 30} GiB came through the pipe"
                raise LogError(what, where=shown, advice=_SAVE)
            file.write(block)
    return copy
