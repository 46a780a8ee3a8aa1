# SPDX-License-Identifier: Apache-2.0
"""Files are written whole or not at all, through links and with the mode they had, and hashed."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

from slipwise.errors import OutputError, SlipwiseError
from slipwise.part_folder import part_folder, sweep_parts

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
    errno.ELOOP: "the links lead in a circle, name another file",
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


def written_place(path: Path) -> Path:
    """Return where a file of this name is written: what a symbolic link leads to, there or not, is followed.

    Raises:
        OSError: links lead in a circle.
    """
    if not path.is_symlink():
        return path
    place = Path(os.path.realpath(path))
    if place.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    return place


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a file in a hidden folder beside `path`, then move it into place in one step.

    A symbolic link stays, and the file that it leads to is written. A file that is there keeps its mode and,
    where the system allows it, its owner. Whatever interrupts the writing, a signal too, leaves the old file
    as it was and no other; what a killed process left in the folder is swept by the next writing there.

    Args:
        path: the file to write.
        write: gets the path of a file that is not there yet, in a folder that is its own.

    Raises:
        OutputError: the file cannot be written.
    """
    with output_errors(path):
        place = written_place(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if place.exists() and not place.is_file():
            raise OutputError(
                "cannot write: this is a device or a pipe", where=str(path), advice="name a file"
            )
        sweep_parts(place.parent)
        with part_folder(place.parent) as folder:
            temporary = folder / place.name
            write(temporary)
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            _take_after(temporary, place)
            temporary.replace(place)


def write_text_whole(path: Path, text: str) -> None:
    """Write `text` as UTF-8 to `path`, whole or not at all.

    Raises:
        OutputError: the file cannot be written.
    """
    write_whole(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of the file's bytes as hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _take_after(temporary: Path, place: Path) -> None:
    """Give the new file owner and mode of the old one, if there is an old one."""
    try:
        old = place.stat()
    except FileNotFoundError:
        return
    with contextlib.suppress(OSError):  # only some may give files away
        os.chown(temporary, old.st_uid, old.st_gid)
    temporary.chmod(stat.S_IMODE(old.st_mode))


def refuse_irregular(path: Path, *, error: type[SlipwiseError]) -> None:
    """Raise where `path` is a pipe or a device: reading one may never end.

    Raises:
        SlipwiseError: of type `error`.
    """
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise error("not a regular file", where=str(path), advice="copy what it gives into a file first")


def read_whole(path: Path, *, most: int, error: type[SlipwiseError], what: str = "") -> bytes:
    """Return the bytes of a regular file of at most `most` bytes; `what` names it in an error.

    Raises:
        SlipwiseError: of type `error`: the file is missing, a folder, a pipe or a device, or too large.
    """
    try:
        refuse_irregular(path, error=error)
        with path.open("rb") as file:
            data = file.read(most + 1)
    except OSError as problem:
        raise error(
            f"cannot read{what and ' '}{what}: {problem.strerror}", where=str(path), advice="check the path"
        ) from problem
    except ValueError as problem:  # the name holds a character that no name may hold
        raise error("not the name of a file", where=str(path), advice="check the path") from problem
    if len(data) > most:
        raise error("the file is too large", where=str(path), advice=f"at most {most} bytes are read")
    return data
