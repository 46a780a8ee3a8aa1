# SPDX-License-Identifier: Apache-2.0
"""Settings say how to read a log, and the command line goes before them."""

from dataclasses import fields
from pathlib import Path

import pytest

from slipwise.calibration import load_settings, make_settings
from slipwise.calibration.log_table import LogTable
from slipwise.calibration.settings import users_dump
from slipwise.cli.run_folder import to_toml
from slipwise.errors import SettingsError
from slipwise.logs import LogOptions


def test_the_table_has_a_key_for_every_option_of_reading() -> None:
    further = {"other_poses", "other_pose_topics"}  # what follows the first in a list
    expected = set(LogTable.model_fields) | {"unknown_after"} | further
    assert {field.name for field in fields(LogOptions)} == expected
    options = LogTable(poses=["a.csv", "b.csv"], pose_topic=["/a", "/b"]).options(0.5, {})
    assert (options.poses, options.other_poses) == (Path("a.csv"), (Path("b.csv"),))
    assert (options.pose_topic, options.other_pose_topics) == ("/a", ("/b",))
    assert LogTable(poses=["a.csv", "b.csv"]).options(0.5, {"poses": Path("c.csv")}).other_poses == ()


def test_settings_become_options_and_given_ones_go_before() -> None:
    log = {
        "wheel_radius": 0.1,
        "wheel_separation": 0.5,
        "poses": "p.txt",
        "columns": {"t": "time"},
        "left_joints": ["a"],
    }
    settings = make_settings({"log": log, "segment": {"unknown_after": 2.0}})
    options = settings.log_options(wheel_separation=0.7, columns={"cmd_v": "vx"})
    assert (options.wheel_radius, options.wheel_separation, options.unknown_after) == (0.1, 0.7, 2.0)
    assert options.poses == Path("p.txt")
    assert options.columns == {"t": "time", "cmd_v": "vx"}
    assert options.left_joints == ("a",)
    assert make_settings({}).log_options() == LogOptions()


def test_settings_with_columns_are_written_as_a_file_that_reads_back(tmp_path: Path) -> None:
    settings = make_settings({"log": {"columns": {"t": "my time", "x": 'a"b'}, "vehicle": "husky"}})
    (tmp_path / "a.toml").write_text(to_toml(users_dump(settings)))
    assert load_settings(tmp_path / "a.toml") == settings


def test_a_wrong_value_is_named_with_its_key() -> None:
    with pytest.raises(SettingsError, match=r"log\.wheel_radius: must be more than 0, not -1"):
        make_settings({"log": {"wheel_radius": -1.0}})
    with pytest.raises(SettingsError, match=r"log\.pose_clock_offset"):
        make_settings({"log": {"pose_clock_offset": "soon"}})
