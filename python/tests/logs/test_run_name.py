# SPDX-License-Identifier: Apache-2.0
"""A run without a name is called like its file."""

from pathlib import Path

import pytest

from slipwise.logs.log import run_name


def test_a_run_is_named_by_its_file_without_the_endings_of_logs(subtests: pytest.Subtests) -> None:
    for path, name in [
        ("drives/monday.csv", "monday"),
        ("drives/monday.csv.gz", "monday"),
        ("monday.2.parquet", "monday.2"),
        ("monday.mcap", "monday"),
        ("bag_folder", "bag_folder"),
        ("monday.txt", "monday.txt"),
        (".csv", "run"),
        ("/", "run"),
    ]:
        with subtests.test(path=path, name=name):
            assert run_name(Path(path)) == name
