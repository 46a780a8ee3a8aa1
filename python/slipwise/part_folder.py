# SPDX-License-Identifier: Apache-2.0
"""Hidden folders for files in the making, locked by their writers, so that dead writers' can be swept."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from pathlib import Path

LOCK = ".writer"
_NAME = re.compile(r"\.slipwise-[0-9a-f]{8}\.part")


@contextlib.contextmanager
def part_folder(parent: Path) -> Iterator[Path]:
    """Make a folder in `parent` that only this user can read; remove it at the end, whatever it holds.

    Raises:
        OSError: it cannot be made.
    """
    # The name is ours before the folder is there: whenever a signal comes, there is something to remove.
    folder = parent / f".slipwise-{secrets.token_hex(4)}.part"
    try:
        folder.mkdir(mode=0o700)
        with locked(folder / LOCK):
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def sweep_parts(parent: Path) -> None:
    """Remove the part folders in `parent` whose writer is dead; what is not ours or in use stays."""
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        for entry in entries:
            if _NAME.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                _sweep(Path(entry.path))


def _sweep(folder: Path) -> None:
    with contextlib.suppress(OSError):
        if folder.stat().st_uid != os.geteuid():
            return
        lock = folder / LOCK
        if lock.exists() and not is_locked(lock):
            shutil.rmtree(folder)


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Create the file and hold a lock on it, which the system lifts when this process ends, however it does.

    It is locked before it gets its name: it is never seen without its lock. A file system without locks
    gives none.

    Raises:
        OSError: the file cannot be created.
    """
    unnamed = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
    handle = os.open(unnamed, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
    try:
        with contextlib.suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        unnamed.rename(path)
        yield
    finally:
        os.close(handle)


def is_locked(path: Path) -> bool:
    """Whether a process holds the file's lock; yes, where that cannot be known."""
    try:
        handle = os.open(path, os.O_WRONLY | os.O_NOFOLLOW)
    except OSError:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(handle)
    return False
