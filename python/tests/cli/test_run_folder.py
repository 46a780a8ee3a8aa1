# SPDX-License-Identifier: Apache-2.0
"""Run folders are whole or gone, never shared, and `latest` names the last good one."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result, left_in

from slipwise.cli.run_folder import INCOMPLETE, killed_runs, run_folder, to_toml
from slipwise.errors import OutputError

Slipwise = Callable[..., Result]


def test_a_run_gets_a_folder_named_by_utc_time_and_command(tmp_path: Path) -> None:
    with run_folder(tmp_path / "runs", "calibrate") as folder:
        assert re.fullmatch(r"\d{8}T\d{6}Z-calibrate", folder.name)
    assert (tmp_path / "runs" / "latest").resolve() == folder.resolve()


def test_two_runs_in_one_second_do_not_share_a_folder(tmp_path: Path) -> None:
    with run_folder(tmp_path, "calibrate") as first, run_folder(tmp_path, "calibrate") as second:
        assert first != second


@pytest.mark.parametrize("failure", [ValueError, KeyboardInterrupt])
def test_a_failed_run_leaves_no_folder_and_the_link_as_it_was(
    tmp_path: Path, failure: type[BaseException]
) -> None:
    with run_folder(tmp_path, "calibrate") as good:
        pass
    with pytest.raises(failure), run_folder(tmp_path, "evaluate") as folder:
        _fail_in(folder, failure)
    assert not folder.exists()
    assert (tmp_path / "latest").resolve() == good.resolve()


def test_a_first_run_that_fails_leaves_nothing_at_all(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="broken"), run_folder(tmp_path / "runs", "evaluate"):
        raise ValueError("broken")
    assert not (tmp_path / "runs").exists()


def test_a_file_of_the_users_named_latest_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "latest").write_text("mine")
    with run_folder(tmp_path, "calibrate"):
        pass
    assert (tmp_path / "latest").read_text() == "mine"


def test_a_file_in_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "runs").touch()
    with pytest.raises(OutputError, match="Not a directory"), run_folder(tmp_path / "runs", "calibrate"):
        pass


def test_toml_reads_back_equal() -> None:
    content = {
        "basis": 'a "quoted" name\n',
        "on": True,
        "terms": {"lon": ["V", "abs(w)"], "ang": []},
        "prior": {"std": 1e-9, "n": 3},
    }
    assert tomllib.loads(to_toml(content)) == content


def _fail_in(folder: Path, failure: type[BaseException]) -> None:
    (folder / "half").touch()
    raise failure


def test_a_folder_is_marked_until_it_is_complete(tmp_path: Path) -> None:
    with run_folder(tmp_path, "calibrate") as folder:
        assert (folder / INCOMPLETE).is_file()
        assert killed_runs(tmp_path) == []  # it goes on
    assert left_in(folder) == set()


def test_a_killed_run_stays_marked_and_the_next_one_says_so(slipwise: Slipwise, drive_csv: Path) -> None:
    script = (
        "import os, signal; from pathlib import Path; from slipwise.cli.run_folder import run_folder\n"
        "with run_folder(Path('runs'), 'evaluate'): os.kill(os.getpid(), signal.SIGKILL)"
    )
    subprocess.run([sys.executable, "-c", script], check=False)
    (killed,) = Path("runs").iterdir()
    assert left_in(killed) == {INCOMPLETE}
    result = slipwise("calibrate", drive_csv, "--basis", "edd-2", "--no-report")
    assert f"Incomplete, since the process was killed, and yours to remove: {killed}." in result.out
    assert result.code == 0
    assert killed_runs(Path("runs")) == [killed]
