# SPDX-License-Identifier: Apache-2.0
"""Vehicles by name and from YAML, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.logs.options import LogOptions
from slipwise.logs.vehicle_description import load_vehicle, vehicle_names


def written(folder: Path, text: str) -> str:
    path = folder / "robot.yaml"
    path.write_text(text)
    return str(path)


def test_every_preset_loads_and_names_its_source(subtests: pytest.Subtests) -> None:
    for name in vehicle_names():
        with subtests.test(name=name):
            assert len(load_vehicle(name).source) > 10


def test_sizes_of_a_preset_are_taken_where_none_are_given() -> None:
    husky = LogOptions(vehicle="husky")
    assert (husky.wheel_radius, husky.wheel_separation) == (0.1651, 0.555)
    assert husky.left_joints == ("front_left_wheel_joint", "rear_left_wheel_joint")
    assert LogOptions(vehicle="husky", wheel_separation=0.54).wheel_separation == 0.54
    assert LogOptions(vehicle="f1tenth").wheelbase == 0.25
    assert husky.wheels is None


def test_a_file_says_how_its_wheels_count(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    text = "vehicle:\n  tracks: {radius: 0.1, separation: 0.5}\n  wheel_scale: [0.5, -1]\n"
    path.write_text(text, encoding="utf-8")
    assert LogOptions(vehicle=str(path)).wheel_scale == (0.5, -1.0)
    assert LogOptions(vehicle=str(path), wheel_scale=(2.0, 1.0)).wheel_scale == (2.0, 1.0)
    (tmp_path / "none.yaml").write_text(text.replace("-1", "0"), encoding="utf-8")
    with pytest.raises(SettingsError, match="a factor is not 0"):
        LogOptions(vehicle=str(tmp_path / "none.yaml"))


def test_a_robotino_that_drives_ahead_turns_its_side_wheels_against_each_other() -> None:
    layout = load_vehicle("robotino").layout
    assert layout is not None
    assert layout.tells_sideways
    speed, _ = layout.wheels_for(np.array([[0.5, 0.0, 0.0]]))
    assert speed[0, 0] == pytest.approx(-speed[0, 2])
    assert speed[0, 1] == pytest.approx(0.0, abs=1e-4)


def test_a_vehicle_whose_wheels_are_all_steered_drives_sideways(subtests: pytest.Subtests) -> None:
    for vehicle, sideways in [
        ("pr2", True),
        ("ranger-mini", True),
        ("robotino", True),
        ("osr-rover", False),
        ("husky", False),
    ]:
        with subtests.test(vehicle=vehicle, sideways=sideways):
            assert LogOptions(vehicle=vehicle).sideways == sideways


def test_a_file_describes_wheels_of_a_kind_of_their_own(tmp_path: Path) -> None:
    text = """vehicle:
  hinge: {name: waist, x: -1.0}
  wheels:
    - {name: fl, x: 0, y: 0.5, radius: 0.4}
    - {name: fr, x: 0, y: -0.5, radius: 0.4}
    - {name: rl, x: -3, y: 0.5, radius: 0.4, behind_hinge: true}
"""
    found = load_vehicle(written(tmp_path, text))
    assert found.hinge is not None
    assert [wheel.behind_hinge for wheel in found.wheels] == [False, False, True]


def test_a_description_that_makes_no_sense_is_refused(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for text, said in [
        ("robot: {}\n", "no section vehicle"),
        ("vehicle: {}\n", "none of them"),
        ("vehicle: {wheelbase: 1.0, tracks: {radius: 1, separation: 1}}\n", "tracks and wheelbase"),
        ("vehicle: {tracks: {radius: -1, separation: 1}}\n", "radius"),
        ("vehicle: {wheels: [{name: a, x: 0, y: 0, radius: 0.1, slides: true}]}\n", "do not tell a motion"),
        (
            "vehicle: {wheels: [{name: a, x: 0, y: 0, radius: 1, pivot: [0, 1]}]}\n",
            "pivot",
        ),
        (
            "vehicle: {wheels: [{name: a, x: 0, y: 0, radius: 0.1}, {name: a, x: 0, y: 1, radius: 0.1}]}\n",
            "same name",
        ),
        ("vehicle: {wheels: [{name: a, x: 0, y: 0, radius: 0.1, colour: red}]}\n", "no such key"),
    ]:
        with subtests.test(text=text, said=said), pytest.raises(SettingsError, match=said):
            load_vehicle(written(tmp_path, text))


def test_an_unknown_name_is_answered_with_those_that_are_known() -> None:
    with pytest.raises(SettingsError, match="husky"):
        LogOptions(vehicle="huskie")
