# SPDX-License-Identifier: Apache-2.0
"""A log becomes a row per parameter; one that cannot be used says why."""

from __future__ import annotations

import contextlib
import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import scaled, sound_log, turned

from slipwise.calibration import Settings, load_settings, make_settings
from slipwise.errors import OlderNames
from slipwise.fleet import LogTask, learn_task
from slipwise.fleet.learned_rows import key_of, log_hash, settings_hash
from slipwise.logs import Log, save_log
from slipwise.logs.vehicle_description import load_vehicle
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


@pytest.mark.slow
def test_a_fleet_says_signs_and_turned_sensors_in_present_keys(tmp_path: Path) -> None:
    """What --wheel-scale and --pose-yaw-offset say of one log; older keys name both."""
    sound = sound_log()
    wheels = replace(sound, runs=tuple(replace(run, commands=None) for run in sound.runs))
    log = scaled(turned(wheels, 1.2), "wheels", 0.5)
    path, settings, vehicle = (tmp_path / name for name in ("log.csv", "fleet.toml", "robot.yaml"))
    save_log(log, path)
    assert "turned by" in learn_task(LogTask(str(path), "one", "", log_hash(path))).failure
    vehicle.write_text(
        "vehicle:\n  tracks: {radius: 0.1, separation: 0.5}\n  wheel_scale: [2, 1]\n", encoding="utf-8"
    )
    settings.write_text(f'[log]\nvehicle = "{vehicle}"\n[sensor_extrinsics]\nyaw = 1.2\n', encoding="utf-8")
    learned = learn_task(LogTask(str(path), "one", str(settings), log_hash(path)))
    assert learned.failure == ""
    for name, true in (("lon.V", -0.05), ("ang.w", -0.4)):
        (row,) = (each for each in learned.rows if each.parameter == name)
        assert row.value == pytest.approx(true, abs=3.0 * row.std)


@pytest.mark.parametrize(
    ("line", "now"),
    [
        ("wheel_scale = [2.0, 1.0]", "a key of the file of log.vehicle, or --wheel-scale"),
        ("pose_yaw_offset = 0.1", "sensor_extrinsics.yaw with the other sign, or --pose-yaw-offset"),
        ("start = 3.0", "where slipwise convert takes it for logs of a fleet: --start"),
    ],
)
def test_older_keys_name_what_a_fleet_has_in_place_of_them(tmp_path: Path, line: str, now: str) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(f"[log]\n{line}\n", encoding="utf-8")
    with pytest.warns(OlderNames, match=now):
        load_settings(path)


def test_another_vehicle_in_the_file_of_the_settings_is_another_key(tmp_path: Path) -> None:
    found = []
    for number, scale in enumerate(("[1, 1]", "[1, -1]", "[1, -1]  # again")):
        path = tmp_path / str(number) / "robot.yaml"
        path.parent.mkdir()
        path.write_text(
            f"vehicle:\n  tracks: {{radius: 0.1, separation: 0.5}}\n  wheel_scale: {scale}\n",
            encoding="utf-8",
        )
        load_vehicle.cache_clear()
        with contextlib.chdir(path.parent):
            found.append(settings_hash(make_settings({"log": {"vehicle": "robot.yaml"}})))
    assert found[0] != found[1] == found[2]


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
