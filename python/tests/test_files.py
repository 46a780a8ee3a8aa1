# SPDX-License-Identifier: Apache-2.0
"""Files are written whole or not at all, whatever interrupts the writing."""

from __future__ import annotations

import errno
import hashlib
import os
import signal
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from slipwise.errors import ModelError, OutputError
from slipwise.files import read_whole, sha256_of, write_text_whole, write_whole


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


def test_a_link_stays_and_the_file_it_leads_to_is_written(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    link = tmp_path / "link.txt"
    link.symlink_to("real/a.txt")
    for text in ("first", "second"):  # the first makes the file
        write_text_whole(link, text)
        assert link.is_symlink()
        assert (tmp_path / "real" / "a.txt").read_text(encoding="utf-8") == text
    assert [p.name for p in (tmp_path / "real").iterdir()] == ["a.txt"]


def test_links_in_a_circle_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").symlink_to("b.txt")
    (tmp_path / "b.txt").symlink_to("a.txt")
    with pytest.raises(OutputError, match=r"links lead in a circle, name another file"):
        write_text_whole(tmp_path / "a.txt", "text")


@pytest.mark.parametrize("mode", [0o600, 0o664, 0o400])
def test_a_file_that_is_there_keeps_its_mode(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old", encoding="utf-8")
    path.chmod(mode)
    write_text_whole(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.read_text(encoding="utf-8") == "new"


def test_nobody_else_can_read_a_private_file_while_it_is_written(tmp_path: Path) -> None:
    modes = []

    def write(path: Path) -> None:
        modes.append(stat.S_IMODE(path.parent.stat().st_mode))
        path.write_text("secret", encoding="utf-8")

    write_whole(tmp_path / "a.txt", write)
    assert modes == [0o700]


def test_what_a_killed_writer_left_is_swept_by_the_next_writing(tmp_path: Path) -> None:
    script = (
        "import os, signal, sys; from pathlib import Path; from slipwise.files import write_whole\n"
        "def write(path):\n    path.write_text('half of')\n    os.kill(os.getpid(), signal.SIGKILL)\n"
        "write_whole(Path(sys.argv[1]), write)"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path / "a.txt")], check=False)
    assert done.returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    assert left.name.endswith(".part")
    write_text_whole(tmp_path / "b.txt", "text")
    assert [p.name for p in tmp_path.iterdir()] == ["b.txt"]


def test_what_is_being_written_or_not_ours_is_not_swept(tmp_path: Path) -> None:
    others = {".slipwise-notes.part", ".a.txt.0123abcd.part", ".slipwise-0123abcd.part"}
    for name in others:
        (tmp_path / name).mkdir()
    (tmp_path / ".slipwise-0123abcd.part" / "letter").touch()  # no writer's lock: not ours

    def write(path: Path) -> None:
        write_text_whole(tmp_path / "b.txt", "while the other is written")
        path.write_text("first", encoding="utf-8")

    write_whole(tmp_path / "a.txt", write)
    assert (tmp_path / "a.txt").read_text(encoding="utf-8") == "first"
    assert {p.name for p in tmp_path.iterdir()} == {"a.txt", "b.txt"} | others


@pytest.mark.parametrize("name", ["pipe", "/dev/zero"])
def test_a_pipe_or_device_is_never_read(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ModelError, match=r"not a regular file \(.*\): copy what it gives into a file first"):
        read_whole(tmp_path / name, most=10, error=ModelError)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("none", "cannot read: No such file"),
        (".", "cannot read: Is a directory"),
        ("a\0b", "not the name of a file"),
    ],
)
def test_what_cannot_be_read_is_said_in_the_kind_of_error_asked_for(
    tmp_path: Path, name: str, expected: str
) -> None:
    with pytest.raises(ModelError, match=expected):
        read_whole(tmp_path / name, most=10, error=ModelError)


def test_a_file_is_read_up_to_the_size_allowed(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"0123456789")
    assert read_whole(tmp_path / "a", most=10, error=ModelError) == b"0123456789"
    with pytest.raises(ModelError, match=r"the file is too large .*at most 9 bytes are read"):
        read_whole(tmp_path / "a", most=9, error=ModelError)
