# SPDX-License-Identifier: Apache-2.0
"""A log becomes a row per parameter; one that cannot be used says why."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import sound_log, turned

from slipwise.calibration import Settings, load_settings
from slipwise.errors import OlderNames
from slipwise.fleet import LogTask, learn_task
from slipwise.fleet.learned_rows import key_of, log_hash, settings_hash
from slipwise.logs import Log, save_log
from slipwise_sim import thesis_drive
from slipwise_sim.known_robot import KnownRobot, known_run


def write_log(path: Path, seed: int, seconds: float = 60.0) -> Path:
    """Write a log of a robot without slip; its stamps count from zero."""
    commands = thesis_drive(seed, seconds)
    run = known_run(KnownRobot(), commands, (0.0, seconds), random=np.random.default_rng(seed))
    save_log(Log((run,)), path)
    return path


@pytest.mark.slow
def test_log_becomes_a_row_per_parameter(tmp_path: Path) -> None:
    path = write_log(tmp_path / "log.csv", 1)
    learned = learn_task(LogTask(str(path), "one", "", log_hash(path)))
    assert learned.failure == ""
    assert learned.key == key_of(log_hash(path), settings_hash(Settings()))
    assert {"ang.w", "lon.V"} <= {row.parameter for row in learned.rows}
    assert learned.seconds > 30.0
    assert learned.distance > 10.0
    assert learned.start == pytest.approx(path.stat().st_mtime)  # the log counts from its own start


def test_log_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("t,speed\n0,1\n", encoding="utf-8")
    learned = learn_task(LogTask(str(path), "one", "", log_hash(path)))
    assert learned.rows == ()
    assert str(path) in learned.failure


def test_log_whose_poses_and_inputs_contradict_each_other_says_so(tmp_path: Path) -> None:
    """A sensor that is turned by 90 degrees showed a robot that drives 0 % and turns as all others do."""
    path = tmp_path / "turned.csv"
    save_log(turned(sound_log(), math.pi / 2.0), path)
    learned = learn_task(LogTask(str(path), "one", "", log_hash(path)))
    assert learned.rows == ()
    assert "their heading is turned by 90 deg" in learned.failure


def test_log_says_how_late_its_robot_is_in_all(tmp_path: Path) -> None:
    path = tmp_path / "sound.csv"
    save_log(replace(sound_log(), runs=tuple(replace(r, wheels=None) for r in sound_log().runs)), path)
    rows = {row.parameter: row for row in learn_task(LogTask(str(path), "one", "", log_hash(path))).rows}
    late = rows["63 % of a step of speed"]
    assert late.value == pytest.approx(0.2, abs=3.0 * late.std)
    assert 0.0 < late.std < 0.05


def test_older_names_of_a_fleets_settings_are_not_said_again_for_each_log(tmp_path: Path) -> None:
    path, settings = tmp_path / "log.csv", tmp_path / "fleet.toml"
    path.write_text("t,speed\n0,1\n", encoding="utf-8")
    settings.write_text("[log]\nwheelbase = 2.0\n", encoding="utf-8")
    with pytest.warns(OlderNames, match=r"log.wheelbase is a key of the file of log.vehicle, or --wheelbase"):
        load_settings(settings)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        learn_task(LogTask(str(path), "one", str(settings), log_hash(path)))


def test_other_settings_are_another_key(tmp_path: Path) -> None:
    other = Settings(basis="edd-2")
    assert settings_hash(other) != settings_hash(Settings())
    assert settings_hash(Settings()) == settings_hash(Settings())


def test_hash_of_a_folder_is_that_of_its_files_and_names(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "a").write_text("1", encoding="utf-8")
    first = log_hash(bag)
    (bag / "a").rename(bag / "b")
    assert log_hash(bag) != first
    (bag / "b").rename(bag / "a")
    assert log_hash(bag) == first
