# SPDX-License-Identifier: Apache-2.0
"""Throttle and steering are read as they are, beside what a car makes of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_cars import commands, write_car_log

from slipwise.errors import LogError
from slipwise.logs import LogOptions, open_log
from slipwise.logs.car_commands import with_car_commands
from slipwise.logs.log import Inputs


def car_inputs(path: Path, **options: object) -> Inputs:
    (run,) = open_log(path, options=LogOptions(vehicle="dart", **options)).runs  # type: ignore[arg-type]
    assert run.commands is not None
    return run.commands


def test_commands_are_kept_as_they_were_given(tmp_path: Path) -> None:
    inputs = car_inputs(write_car_log(tmp_path / "car.csv", 30.0))
    _, throttle, steering = commands(30.0, 1)
    assert inputs.car is not None
    assert np.allclose(inputs.car.throttle, throttle, atol=1e-6)
    assert np.allclose(inputs.car.steering, steering, atol=1e-6)
    assert (inputs.car.top_speed, inputs.car.curvature) == (4.0, 2.0)


def test_what_the_car_makes_of_them_is_in_metres_and_radians(tmp_path: Path) -> None:
    inputs = car_inputs(write_car_log(tmp_path / "car.csv", 60.0))
    late = inputs.t > 40.0
    assert 0.5 < float(np.abs(inputs.v[late]).max()) < 3.0
    assert float(np.abs(inputs.omega[late]).max()) > 0.5


def test_a_command_is_taken_by_what_was_known_before_it(tmp_path: Path) -> None:
    whole = write_car_log(tmp_path / "car.csv", 60.0)
    lines = whole.read_text().splitlines()
    part = tmp_path / "part.csv"
    part.write_text("\n".join(lines[:601]) + "\n")
    long, short = car_inputs(whole), car_inputs(part)
    assert np.array_equal(long.v[:600], short.v)
    assert np.array_equal(long.omega[:600], short.omega)


def test_the_direction_of_the_path_reaches_no_command_where_only_positions_are_known(tmp_path: Path) -> None:
    path = write_car_log(tmp_path / "car.csv", 40.0)
    rows = [line.rpartition(",")[0] for line in path.read_text().splitlines()]
    path.write_text("\n".join(rows) + "\n")
    options = LogOptions(vehicle="dart")
    log = open_log(path, options=options)
    (run,) = log.runs
    assert run.commands is not None
    assert run.commands.car is not None
    assert run.poses.course
    told = Inputs(run.commands.t, run.commands.car.throttle, run.commands.vy, run.commands.car.steering)
    turned = replace(run, commands=told, poses=replace(run.poses, yaw=run.poses.yaw + 1.0))
    (again,) = with_car_commands(replace(log, runs=(turned,)), options).runs
    assert again.commands is not None
    assert np.array_equal(again.commands.v, run.commands.v)
    assert np.array_equal(again.commands.omega, run.commands.omega)
    assert float(np.abs(run.commands.v).max()) > 0.5


def test_a_cut_log_keeps_its_commands_beside_their_stamps(tmp_path: Path) -> None:
    inputs = car_inputs(write_car_log(tmp_path / "car.csv", 30.0), start=10.0, end=20.0)
    _, throttle, _ = commands(30.0, 1)
    assert inputs.car is not None
    assert len(inputs.car.throttle) == len(inputs)
    assert inputs.car.throttle[0] == pytest.approx(throttle[200], abs=1e-6)


def test_a_throttle_in_per_cent_is_refused(tmp_path: Path) -> None:
    path = write_car_log(tmp_path / "car.csv", 20.0, largest=100.0)
    with pytest.raises(LogError, match=r"throttle reaches .*command-scale"):
        car_inputs(path)


def test_a_scale_turns_the_steering_round(tmp_path: Path) -> None:
    path = write_car_log(tmp_path / "car.csv", 20.0)
    turned, plain = car_inputs(path, command_scale=(1.0, -1.0)).car, car_inputs(path).car
    assert turned is not None
    assert plain is not None
    assert np.array_equal(turned.steering, -plain.steering)


def test_without_a_vehicle_the_columns_are_no_commands(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="missing columns"):
        open_log(write_car_log(tmp_path / "car.csv", 10.0))
