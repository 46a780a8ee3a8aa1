# SPDX-License-Identifier: Apache-2.0
"""Logs are put to the vehicle that drove them, few of each, and a finished model is scored on a log."""

from __future__ import annotations

from pathlib import Path

import pytest
from data_sets import DataSet
from fleet_left_out import MOST_LOGS, TYPES, chosen_logs, errors_on, vehicle_of
from fleet_logs import simulated_log

import slipwise
from slipwise.calibration import Settings


def test_logs_of_one_robot_in_two_folders_are_of_one_vehicle() -> None:
    members = TYPES["skid-steer"]
    assert vehicle_of("warthog/grass", members) == vehicle_of("warthog_windows/sand", members)
    assert vehicle_of("drive_test/warthog", members) != vehicle_of("warthog/grass", members)
    assert vehicle_of("create/MRCLAM6_R1", members) is None


def test_few_logs_of_a_vehicle_are_spread_over_all() -> None:
    sets = [DataSet(f"warthog/{k:02d}", Path(f"{k}.csv"), 5.0, None) for k in range(20)]
    ((vehicle, chosen),) = chosen_logs(sets, TYPES["skid-steer"]).items()
    assert vehicle == "Warthog"
    assert 1 < len(chosen) <= MOST_LOGS
    assert chosen[-1].name > "warthog/14"


@pytest.mark.slow
def test_a_model_predicts_another_drive_of_its_vehicle_better_than_one_of_another() -> None:
    settings = Settings(basis="edd-2")
    mine, other = (
        slipwise.calibrate(simulated_log(vehicle, 0, 60.0), input="wheel", settings=settings).model
        for vehicle in (2, 5)
    )
    there = simulated_log(2, 1, 60.0)
    assert errors_on(there, "wheel", mine) < errors_on(there, "wheel", other)
