# SPDX-License-Identifier: Apache-2.0
"""Logs are found in folders and by patterns, with the folder's name as the vehicle."""

from __future__ import annotations

from pathlib import Path

import pytest

from slipwise.errors import LogError
from slipwise.fleet import find_logs


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    for name in ("red/a.csv", "red/b.mcap", "blue/c.csv.gz", "blue/notes.txt", "blue/.hidden.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    bag = tmp_path / "blue" / "drive"
    bag.mkdir()
    (bag / "metadata.yaml").touch()
    (bag / "drive.db3").touch()
    return tmp_path


def test_folder_gives_all_logs_below_it_and_their_vehicles(logs: Path) -> None:
    found = [(path.name, vehicle) for path, vehicle in find_logs([logs])]
    assert found == [("c.csv.gz", "blue"), ("drive", "blue"), ("a.csv", "red"), ("b.mcap", "red")]


def test_pattern_gives_what_it_matches(logs: Path) -> None:
    found = find_logs([f"{logs}/*/*.csv"], vehicle="husky-1")
    assert [(path.name, vehicle) for path, vehicle in found] == [("a.csv", "husky-1")]


def test_log_that_two_places_name_is_there_once(logs: Path) -> None:
    assert len(find_logs([logs / "red", logs / "red" / "a.csv"])) == 2


@pytest.mark.parametrize("place", ["nowhere", "nowhere/*.csv"])
def test_place_that_is_not_there_is_refused(logs: Path, place: str) -> None:
    with pytest.raises(LogError, match="no such file or folder"):
        find_logs([logs / place])


def test_folder_without_logs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="no log"):
        find_logs([tmp_path])


def test_address_is_a_log_of_the_folder_that_it_lies_in() -> None:
    found = find_logs(["https://host/fleet/husky%201/a.mcap?key=secret", "s3://bucket/b.mcap"])
    assert [(str(path), vehicle) for path, vehicle in found] == [
        ("https:/host/fleet/husky%201/a.mcap?key=secret", "husky 1"),
        ("s3:/bucket/b.mcap", "unknown"),
    ]


def test_list_stands_for_the_places_in_it(logs: Path) -> None:
    text = f"# of may\n{logs}/red\n\n  {logs}/blue/*.gz  \nhttps://host/green/a.csv\n"
    (logs / "some.txt").write_text(text, encoding="utf-8")
    found = [(path.name, vehicle) for path, vehicle in find_logs([f"@{logs}/some.txt"])]
    assert found == [("c.csv.gz", "blue"), ("a.csv", "red"), ("b.mcap", "red"), ("a.csv", "green")]


def test_list_that_cannot_be_read_is_refused(logs: Path) -> None:
    with pytest.raises(LogError, match="cannot read the list"):
        find_logs([f"@{logs}/none.txt"])


def test_log_of_an_autopilot_is_found(tmp_path: Path) -> None:
    for name in ("a.bin", "b.tlog", "c.ulg"):
        (tmp_path / name).touch()
    assert len(find_logs([tmp_path])) == 3


def test_links_in_a_circle_are_followed_once(logs: Path) -> None:
    for name in ("around", "again"):
        (logs / "red" / name).symlink_to(".")
    (logs / "blue" / "up").symlink_to("..")
    assert [path.name for path, _ in find_logs([logs])] == ["c.csv.gz", "drive", "a.csv", "b.mcap"]
