# SPDX-License-Identifier: Apache-2.0
"""Files are written whole or not at all, whatever interrupts the writing."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from slipwise.errors import OutputError
from slipwise.files import sha256_of, write_text_whole, write_whole


def raising(problem: BaseException) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_text("half of", encoding="utf-8")
        raise problem

    return write


def test_file_has_the_text_and_folders_on_the_way_are_made(tmp_path: Path) -> None:
    path = tmp_path / "new" / "deep" / "a.txt"
    write_text_whole(path, "größe\n")
    assert path.read_text(encoding="utf-8") == "größe\n"
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("problem", [ValueError("no"), KeyboardInterrupt(), SystemExit(3)])
def test_interrupted_writing_keeps_the_old_file_and_leaves_nothing_else(
    tmp_path: Path, problem: BaseException
) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old", encoding="utf-8")
    with pytest.raises(type(problem)):
        write_whole(path, raising(problem))
    assert path.read_text(encoding="utf-8") == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("problem", [ValueError("no"), KeyboardInterrupt()])
def test_interrupted_first_writing_leaves_no_file_at_all(tmp_path: Path, problem: BaseException) -> None:
    with pytest.raises(type(problem)):
        write_whole(tmp_path / "a.txt", raising(problem))
    assert list(tmp_path.iterdir()) == []


def test_full_disk_is_said_with_advice_and_leaves_nothing(tmp_path: Path) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    with pytest.raises(OutputError) as caught:
        write_whole(tmp_path / "a.txt", raising(full))
    assert str(caught.value) == (
        f"cannot write: No space left on device ({tmp_path / 'a.txt'}): "
        "the disk is full, free some space or choose another folder"
    )
    assert list(tmp_path.iterdir()) == []


def test_missing_permission_is_said_with_advice(tmp_path: Path) -> None:
    denied = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    with pytest.raises(
        OutputError, match=r"cannot write: Permission denied \(.*a\.txt\): choose a folder you may write to"
    ):
        write_whole(tmp_path / "a.txt", raising(denied))


def test_folder_in_place_of_the_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(OutputError, match=r"Is a directory \(.*a\.txt\): this is a folder, name a file"):
        write_text_whole(tmp_path / "a.txt", "text")
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_file_in_place_of_a_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(OutputError, match=r"\(.*file/a\.txt\): .*choose another folder"):
        write_text_whole(tmp_path / "file" / "a.txt", "text")


def test_file_is_readable_as_the_umask_allows(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_text_whole(tmp_path / "a.txt", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o640


def test_hash_is_that_of_the_bytes(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"slip\x00wise")
    assert sha256_of(path) == hashlib.sha256(b"slip\x00wise").hexdigest()
