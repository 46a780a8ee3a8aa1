# SPDX-License-Identifier: Apache-2.0
"""Run folders are whole or gone, never shared, and `latest` names the last good one."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from slipwise.cli.run_folder import run_folder, to_toml
from slipwise.errors import OutputError


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
