# SPDX-License-Identifier: Apache-2.0
"""Folders for files in the making: private, gone at the end, and swept once their writer is dead."""

import stat
import subprocess
import sys
from pathlib import Path

import pytest

from slipwise.part_folder import LOCK, is_locked, locked, part_folder, sweep_parts


def test_a_folder_is_private_locked_and_gone_at_the_end(tmp_path: Path) -> None:
    with part_folder(tmp_path) as folder:
        assert folder.parent == tmp_path
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        assert is_locked(folder / LOCK)
        (folder / "half").write_text("half")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_gone_after_an_error_too(tmp_path: Path) -> None:
    def write() -> None:
        with part_folder(tmp_path) as folder:
            (folder / "half").write_text("half")
            raise RuntimeError("broken")

    with pytest.raises(RuntimeError, match="broken"):
        write()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_use_is_not_swept(tmp_path: Path) -> None:
    with part_folder(tmp_path) as folder:
        sweep_parts(tmp_path)
        assert folder.is_dir()


def test_the_folder_of_a_killed_writer_is_swept(tmp_path: Path) -> None:
    writer = (
        "import os, sys; from pathlib import Path; from slipwise.part_folder import part_folder\n"
        "with part_folder(Path(sys.argv[1])): os.kill(os.getpid(), 9)"
    )
    assert subprocess.run([sys.executable, "-c", writer, str(tmp_path)], check=False).returncode == -9
    assert len(list(tmp_path.iterdir())) == 1
    sweep_parts(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_only_looks_like_one_stays(tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / LOCK).touch()
    places = tmp_path / "places"
    places.mkdir()
    (places / ".slipwise-0123abcd.part").mkdir()  # no lock: its writer may be about to make it
    (places / ".slipwise-0123abce.part").symlink_to(elsewhere, target_is_directory=True)
    (places / ".slipwise-0123abcf.part").write_text("a file")
    (places / "slipwise-0123abcd.part").mkdir()
    (places / "slipwise-0123abcd.part" / LOCK).touch()
    before = sorted(places.iterdir())
    sweep_parts(places)
    assert sorted(places.iterdir()) == before
    assert (elsewhere / LOCK).exists()


def test_a_folder_that_is_not_there_has_nothing_to_sweep(tmp_path: Path) -> None:
    sweep_parts(tmp_path / "missing")
    assert not (tmp_path / "missing").exists()


def test_a_lock_ends_with_its_block_and_is_assumed_where_nobody_can_know(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with locked(path):
        assert is_locked(path)
        assert list(tmp_path.iterdir()) == [path]
    assert not is_locked(path)
    assert is_locked(tmp_path / "missing")
