# SPDX-License-Identifier: Apache-2.0
"""A run without a name is called like its file."""

from pathlib import Path

import pytest

from slipwise.logs.run_name import run_name


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("drives/monday.csv", "monday"),
        ("drives/monday.csv.gz", "monday"),
        ("monday.2.parquet", "monday.2"),
        ("monday.mcap", "monday"),
        ("bag_folder", "bag_folder"),
        ("monday.txt", "monday.txt"),
        (".csv", "run"),
        ("/", "run"),
    ],
)
def test_a_run_is_named_by_its_file_without_the_endings_of_logs(path: str, name: str) -> None:
    assert run_name(Path(path)) == name
