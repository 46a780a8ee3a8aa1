# SPDX-License-Identifier: Apache-2.0
"""PX4 and ArduPilot get what was identified, in their units, in files that their own tools read back."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from sample_models import LIMITS, Made, make_model, named

from slipwise.errors import ModelError, SettingsError
from slipwise.export import Exported, ExportOptions, export_model

COMMANDS = replace(named("edd-2", lon__V=-0.1, ang__w=-0.4), commands=True)  # reaches 0.9 and 0.6
WHEELS = named("edd-2", lon__V=-0.1, ang__w=-0.4)
LIMITED = replace(COMMANDS, limits={"speed": LIMITS["speed"], "yaw_rate": LIMITS["yaw_rate"]})


def exported(made: Made, target: str, **options: object) -> Exported:
    return export_model(make_model(made), target, name="m.yaml", options=ExportOptions(**options))  # type: ignore[arg-type]


def px4_values(text: str) -> dict[str, float]:
    """Read a file of QGroundControl's format: five columns, comments begin a line."""
    rows = [line.split("\t") for line in text.splitlines() if line and not line.startswith("#")]
    assert all(row[:2] == ["1", "1"] and row[4] in ("6", "9") and len(row) == 5 for row in rows)
    assert len({row[2] for row in rows}) == len(rows)
    return {row[2]: float(row[3]) for row in rows}


def ardupilot_values(text: str, folder: Path) -> dict[str, float]:
    read = pytest.importorskip("pymavlink.mavparm").MAVParmDict()
    path = folder / "a.param"
    path.write_text(text)
    assert read.load(str(path), use_excludes=False)
    return dict(read)


def test_pymavlink_reads_back_what_was_said_to_be_written(tmp_path: Path) -> None:
    logged = {"ATC_STR_RAT_FF": 0.2, "CRUISE_SPEED": 2.0, "CRUISE_THROTTLE": 50.0}
    made = exported(LIMITED, "ardupilot", ardupilot="4.7", logged=logged, limits=True)
    read = ardupilot_values(made.text, tmp_path)
    assert set(read) == set(made.values)
    gains = (0.9 * 1.1, 0.6 * 0.9)  # of the body, behind limits with gains of their own
    expected = {
        "ATC_STR_RAT_FF": 0.2 / gains[1],
        "CRUISE_SPEED": 2.0 * gains[0],
        "ATC_ACCEL_MAX": 0.8 * gains[0],
        "ATC_DECEL_MAX": 1.7 * gains[0],
        "ATC_STR_RAT_MAX": math.degrees(0.7),
        "ATC_STR_ACC_MAX": math.degrees(1.3 * gains[1]),
        "ATC_STR_DEC_MAX": math.degrees(0.9 * gains[1]),
        "MOT_THR_MIN": round(0.1 * 50.0 / 2.0),
        "MOT_SLEWRATE": round(0.8 * 50.0 / 2.0),
    }
    assert read == pytest.approx(expected, rel=1e-5)
    assert set(made.kept) == {"WENC_RADIUS", "WENC2_RADIUS", "TURN_RADIUS"}


@pytest.mark.parametrize(("version", "name"), [("1.16", "RD_MAX_THR_YAW_R"), ("1.17", "RO_YAW_RATE_CORR")])
def test_feed_forward_of_yaw_is_corrected_by_what_the_robot_reached(version: str, name: str) -> None:
    made = exported(COMMANDS, "px4", px4=version, logged={name: 1.8})
    read = px4_values(made.text)
    assert read[name] == pytest.approx(1.8 * 0.6 if version == "1.16" else 1.8 / 0.6, rel=1e-5)
    assert "RO_YAW_RATE_LIM" not in read
    assert "1.8 was in force" in made.text


def test_a_new_full_throttle_speed_changes_the_yaw_rates_feed_forward_too() -> None:
    """Of u = corr w b / (2 max) the body turns at 0.6 w: with 0.9 max, corr 0.9 / 0.6 turns at w."""
    read = px4_values(exported(COMMANDS, "px4", px4="1.17", logged={"RO_MAX_THR_SPEED": 2.0}).text)
    assert read["RO_MAX_THR_SPEED"] == pytest.approx(1.8)
    assert read["RO_YAW_RATE_CORR"] == pytest.approx(0.9 / 0.6)


def test_the_correction_of_wheels_needs_nothing_logged() -> None:
    read = px4_values(exported(WHEELS, "px4", px4="1.17", wheel_separation=0.5).text)
    assert read["RO_YAW_RATE_CORR"] == pytest.approx(0.9 / 0.6)
    assert read["RD_WHEEL_TRACK"] == 0.5


def test_learned_limits_are_written_and_absent_ones_are_not() -> None:
    limited, free = (exported(made, "px4", px4="1.17", limits=True) for made in (LIMITED, COMMANDS))
    assert px4_values(limited.text)["RO_YAW_DECEL_LIM"] == pytest.approx(math.degrees(0.9 * 0.54), rel=1e-5)
    assert px4_values(limited.text)["RO_MAX_THR_SPEED"] == pytest.approx(1.1 * 0.99)
    assert {"RO_ACCEL_LIM", "RO_DECEL_LIM", "RO_YAW_ACCEL_LIM", "RO_MAX_THR_SPEED"} <= set(free.kept)
    assert "shows no limit of the acceleration" in free.kept["RO_ACCEL_LIM"]
    assert px4_values(free.text)["RO_YAW_RATE_LIM"] == pytest.approx(math.degrees(0.7), rel=1e-5)
    assert px4_values(free.text)["RO_SPEED_LIM"] == 1.35


def test_limits_are_left_unless_they_are_asked_for() -> None:
    made = exported(LIMITED, "px4", px4="1.17")
    assert not any(name.endswith("_LIM") for name in {*made.values, *made.kept})
    assert "Limits are left as they are (RO_SPEED_LIM" in made.text


def test_a_vehicle_that_steers_gets_its_steering_angle() -> None:
    read = px4_values(exported(COMMANDS, "px4", px4="1.17", min_turning_radius=2.0, wheel_base=1.0).text)
    assert read["RA_MAX_STR_ANG"] == pytest.approx(math.atan(1.0 / (2.0 * 0.9 / 0.6)), rel=1e-5)
    assert read["RA_WHEEL_BASE"] == 1.0
    turns = {"RO_YAW_RATE_CORR", "RD_WHEEL_TRACK"}
    assert not turns & set(read)
    known = exported(replace(COMMANDS, wheelbase=1.0), "px4", px4="1.17", wheel_separation=0.5)
    assert not turns & set(known.values)


@pytest.mark.parametrize("first_y", [-0.25, 0.25])
def test_the_side_of_a_wheel_follows_a_y_that_points_to_the_right(first_y: float, tmp_path: Path) -> None:
    """A robot whose wheels go straight and that turns to the left has the larger wheel on the right."""
    made = replace(named("full-linear-6"), values={"ang.V": 0.1}, std=0.001)
    logged = {"WENC_RADIUS": 0.1, "WENC2_RADIUS": 0.1, "WENC_POS_Y": first_y, "WENC2_POS_Y": -first_y}
    text = exported(made, "ardupilot", ardupilot="4.6", wheel_separation=0.5, logged=logged).text
    read = ardupilot_values(text, tmp_path)
    left, right = 0.1 * (1.0 - 0.1 * 0.5 / 2.0), 0.1 * (1.0 + 0.1 * 0.5 / 2.0)
    first, second = (left, right) if first_y < 0.0 else (right, left)
    assert (read["WENC_RADIUS"], read["WENC2_RADIUS"]) == pytest.approx((first, second), rel=1e-5)


@pytest.mark.parametrize("target", ["px4", "ardupilot"])
@pytest.mark.parametrize("change", [{"std": 0.5}, {"identifiable": False, "std": 0.25}])
def test_nothing_that_was_not_identified_is_written(target: str, change: dict[str, float]) -> None:
    logged = {"RO_MAX_THR_SPEED": 2.0, "ATC_STR_RAT_FF": 0.2, "CRUISE_SPEED": 2.0}
    options = {"px4": "1.17", "ardupilot": "4.6", "logged": logged}
    made = exported(replace(COMMANDS, **change), target, **options)
    assert made.values == {}
    assert "ATC_STR_RAT_FF" in made.kept or "RO_YAW_RATE_CORR" in made.kept


def test_every_number_has_its_unit_its_deviation_and_its_source() -> None:
    text = exported(LIMITED, "px4", px4="1.17", logged={"RO_MAX_THR_SPEED": 2.0}).text
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if line.startswith("1\t1\t"):
            assert lines[i - 1].startswith("# ["), line
            assert "+-" in lines[i - 1], line
    assert "from lon.V: 2 was in force" in text
    assert "Parameters of PX4 1.17, and of no other version." in text


@pytest.mark.parametrize("target", ["px4", "ardupilot"])
def test_a_version_that_is_not_named_is_asked_for(target: str) -> None:
    with pytest.raises(ModelError, match=rf"other names in each version: add --{target}"):
        exported(COMMANDS, target)
    with pytest.raises(SettingsError, match="no table of parameters"):
        exported(COMMANDS, target, px4="2.0", ardupilot="2.0")
