# SPDX-License-Identifier: Apache-2.0
"""Files are written whole or not at all, and identified by their hash."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path

from slipwise.errors import OutputError

_ADVICE = {
    errno.EACCES: "choose a folder you may write to",
    errno.EPERM: "choose a folder you may write to",
    errno.EROFS: "the file system is read-only, choose another folder",
    errno.EFBIG: "the file would be larger than the system allows",
    errno.ENOSPC: "the disk is full, free some space or choose another folder",
    errno.EDQUOT: "your quota is used up, free some space or choose another folder",
    errno.EISDIR: "this is a folder, name a file",
    errno.EEXIST: "a part of the path is a file, choose another folder",
    errno.ENOTDIR: "a part of the path is a file, choose another folder",
}


@contextlib.contextmanager
def output_errors(path: Path) -> Iterator[None]:
    """Turn the operating system's errors about writing `path` into an OutputError with advice."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        advice = _ADVICE.get(error.errno or 0, "check the path")
        raise OutputError(f"cannot write: {reason}", where=str(path), advice=advice) from error


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file beside `path`, then move it into place in one step.

    Whatever interrupts the writing, a signal too, leaves the old file as it was and no temporary file.

    Raises:
        OutputError: the file cannot be written.
    """
    with output_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if path.exists() and not path.is_file():
            raise OutputError(
                "cannot write: this is a device or a pipe", where=str(path), advice="name a file"
            )
        # The name is ours before the file is there: whenever a signal comes, there is something to remove.
        temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
        try:
            temporary.touch(exist_ok=False)
            write(temporary)
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def write_text_whole(path: Path, text: str) -> None:
    """Write `text` as UTF-8 to `path`, whole or not at all.

    Raises:
        OutputError: the file cannot be written.
    """
    write_whole(path, lambda temporary: _write_text(temporary, text))


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of the file's bytes as hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
