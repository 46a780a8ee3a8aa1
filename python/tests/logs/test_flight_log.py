# SPDX-License-Identifier: Apache-2.0
"""Logs of autopilots become logs of rovers: x east, y north, turning left is positive, guesses are told."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from sample_flights import (
    RADIUS,
    RATE,
    SEPARATION,
    SPEED,
    Flight,
    made_flight,
    write_dataflash,
    write_tlog,
    write_ulog,
)

from slipwise.errors import LogError, SettingsError
from slipwise.extras import to_install
from slipwise.logs import LogOptions, open_log
from slipwise.logs.flight_log import flight_format
from slipwise.logs.px4 import MOST_RETURNS, _Forward
from slipwise.logs.survey import survey_log

pytest.importorskip("pymavlink")
pytest.importorskip("pyulog")

Write = Callable[[Path, Flight], Path]
WRITERS: dict[str, Write] = {"drive.bin": write_dataflash, "drive.tlog": write_tlog, "drive.ulg": write_ulog}
OPTIONS = LogOptions(wheel_radius=RADIUS)


@pytest.fixture(params=WRITERS)
def file(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return WRITERS[request.param](tmp_path / request.param, made_flight())


def test_poses_are_east_north_up(file: Path) -> None:
    flight, (run,) = made_flight(), open_log(file, options=OPTIONS).runs
    np.testing.assert_allclose(run.poses.t, flight.t, atol=1e-6)
    np.testing.assert_allclose(run.poses.x, flight.east, atol=1e-4)
    np.testing.assert_allclose(run.poses.y, flight.north, atol=1e-4)
    np.testing.assert_allclose(np.unwrap(run.poses.yaw), np.pi / 2 - flight.heading, atol=1e-4)
    assert run.poses.z is not None
    np.testing.assert_allclose(run.poses.z, 1.0)
    assert run.name == "drive"


def test_commands_and_wheels_turn_right_with_a_negative_yaw_rate(file: Path) -> None:
    (run,) = open_log(file, options=OPTIONS).runs
    for inputs in (run.commands, run.wheels):
        assert inputs is not None
        np.testing.assert_allclose(inputs.v[1:], SPEED, rtol=1e-4)
        np.testing.assert_allclose(inputs.omega[1:], -RATE, rtol=1e-3)
        assert abs(inputs.t[1] - 5.05) < 0.06


def test_what_was_guessed_is_told(file: Path) -> None:
    notes = " ".join(open_log(file, options=OPTIONS).notes)
    assert "poses are those of" in notes
    assert "commands are" in notes


def test_tilt_is_up_and_to_the_left(tmp_path: Path) -> None:
    (run,) = open_log(write_dataflash(tmp_path / "a.bin", made_flight())).runs
    assert run.poses.roll is not None
    assert run.poses.pitch is not None
    np.testing.assert_allclose(run.poses.roll, np.radians(2.0), atol=1e-6)
    np.testing.assert_allclose(run.poses.pitch, -np.radians(3.0), atol=1e-6)
    (run,) = open_log(write_ulog(tmp_path / "a.ulg", made_flight())).runs
    assert run.poses.roll is not None
    np.testing.assert_allclose(run.poses.roll, 0.04, atol=1e-3)


def test_a_receiver_that_is_rtk_fixed_is_preferred_to_the_estimator(tmp_path: Path) -> None:
    flight = made_flight()
    path = write_dataflash(tmp_path / "a.bin", flight, rtk=True)
    log = open_log(path)
    assert "poses are GPS, RTK-fixed, of the antenna, with yaw of ATT; x is east, y north" in log.notes
    np.testing.assert_allclose(log.runs[0].poses.y, flight.north, atol=0.02)
    np.testing.assert_allclose(log.runs[0].poses.x, flight.east, atol=0.02)
    (run,) = open_log(path, options=LogOptions(pose_topic="XKF1")).runs
    np.testing.assert_allclose(run.poses.y, flight.north, atol=1e-4)
    with pytest.raises(SettingsError, match=r"no poses in NKF1 .*: one of XKF1, GPS"):
        open_log(path, options=LogOptions(pose_topic="NKF1"))


def test_a_reset_of_the_estimator_begins_a_new_frame(tmp_path: Path) -> None:
    (run,) = open_log(write_ulog(tmp_path / "a.ulg", made_flight(), reset_at=100)).runs
    assert run.poses.frame.tolist() == [0] * 100 + [1] * 300


def test_without_setpoints_or_sizes_it_is_said_what_is_missing(tmp_path: Path) -> None:
    log = open_log(write_ulog(tmp_path / "a.ulg", made_flight(), manual=True))
    assert log.runs[0].commands is None
    assert log.runs[0].wheels is None
    notes = " ".join(log.notes)
    assert "no commands: the log has no setpoint of speed" in notes
    assert "wheel_encoders is not used: give --wheel-radius and --wheel-separation" in notes


def test_the_separation_is_that_of_the_parameters_unless_it_is_given(tmp_path: Path) -> None:
    path = write_dataflash(tmp_path / "a.bin", made_flight())
    assert any(f"wheels are WENC, {SEPARATION:g} m apart" in note for note in open_log(path).notes)
    (run,) = open_log(path, options=LogOptions(wheel_separation=1.0)).runs
    assert run.wheels is not None
    np.testing.assert_allclose(run.wheels.omega, -RATE * SEPARATION, rtol=1e-3)


def test_inspect_says_what_each_message_is_used_as(file: Path) -> None:
    survey = survey_log(file, OPTIONS)
    assert survey.format == flight_format(file)
    used = {role for part in survey.parts for role in part.used_as.split(", ") if role}
    assert used == {"command", "wheel", "pose"}
    assert all(part.count == 400 for part in survey.parts)


def test_a_log_that_is_cut_off_gives_what_is_whole_or_says_so(file: Path) -> None:
    data = file.read_bytes()
    file.write_bytes(data[: len(data) // 2])
    (run,) = open_log(file, options=OPTIONS).runs
    assert 150 <= len(run.poses) <= 250


def test_a_message_without_length_is_not_read_for_ever(tmp_path: Path) -> None:
    path = write_dataflash(tmp_path / "a.bin", made_flight(1.0))
    data = bytearray(path.read_bytes())
    name = data.index(b"XKF1")  # in the message that declares it, before its format and labels
    data[name - 1] = 0  # its length
    data[name + 4 : name + 84] = bytes(80)
    path.write_bytes(data)
    with pytest.raises(LogError, match="a message without length"):
        open_log(path)


def test_a_log_without_poses_names_what_there_is(tmp_path: Path) -> None:
    path = write_dataflash(tmp_path / "a.bin", made_flight(1.0))
    path.write_bytes(path.read_bytes().replace(b"XKF1", b"XKFX").replace(b"GPS\0", b"GPX\0"))
    with pytest.raises(LogError, match="no poses: there is ATT, STER, THR, WENC"):
        open_log(path)


@pytest.mark.parametrize(("name", "module", "extra"), [
    ("drive.bin", "pymavlink.DFReader", "mavlink"), ("drive.tlog", "pymavlink.mavutil", "mavlink"),
    ("drive.ulg", "pyulog", "px4"),
])  # fmt: skip
def test_a_missing_library_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str, extra: str
) -> None:
    path = WRITERS[name](tmp_path / name, made_flight(1.0))
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delattr("pymavlink.mavutil", raising=False)
    with pytest.raises(LogError, match="is not installed .*" + to_install(extra)):
        open_log(path)


def test_other_files_are_none_of_these(tmp_path: Path) -> None:
    path = tmp_path / "a"
    for data in (b"t,x,y,yaw\n", b"PAR1", b"\x89MCAP0\r\n", b"\x00" * 20):
        path.write_bytes(data)
        assert flight_format(path) is None


def test_poses_without_a_heading_are_not_used(tmp_path: Path) -> None:
    path = write_ulog(tmp_path / "a.ulg", made_flight())
    whole = path.read_bytes()
    path.write_bytes(whole.replace(b"float heading;", b"float HEADING;"))
    assert path.read_bytes() != whole
    with pytest.raises(LogError, match=r"no poses: there is .*vehicle_local_position"):
        open_log(path)


def test_file_that_is_gone_back_in_for_ever_ends_with_an_error(tmp_path: Path) -> None:
    (tmp_path / "a.ulg").write_bytes(bytes(200))
    with _Forward(io.FileIO(tmp_path / "a.ulg")) as file:
        places = [file.seek(100), *(file.seek(50) for _ in range(MOST_RETURNS))]
        assert places[-1] == 50
        with pytest.raises(EOFError, match="damaged"):
            file.seek(50)
