# SPDX-License-Identifier: Apache-2.0
"""The tables of firmwares know their versions, and refuse the ones that they do not hold."""

from __future__ import annotations

import math

import pytest

from slipwise.errors import SettingsError
from slipwise.export.firmware_table import ARDUPILOT, PX4, FirmwareTable


def names(table: FirmwareTable, version: str) -> set[str]:
    return {parameter.name for parameter in table.of_version(version)}


def test_names_come_and_go_with_the_versions() -> None:
    assert names(PX4, "1.16") - names(PX4, "1.17") == {"RD_MAX_THR_YAW_R"}
    assert names(PX4, "1.17") - names(PX4, "1.16") == {"RO_YAW_RATE_CORR"}
    assert names(ARDUPILOT, "4.7") - names(ARDUPILOT, "4.6") == {"ATC_STR_DEC_MAX"}


def test_no_version_is_guessed(subtests: pytest.Subtests) -> None:
    for version in ["1.15", "1.18", "1", "", "1.16.0", "4.6", "latest"]:
        with (
            subtests.test(version=version),
            pytest.raises(SettingsError, match=r"no table of parameters for PX4 .* one of 1\.16, 1\.17"),
        ):
            PX4.of_version(version)


def test_yaw_is_in_degrees_and_a_steering_angle_in_radians() -> None:
    units = {parameter.name: parameter for parameter in PX4.of_version("1.17")}
    assert units["RO_YAW_RATE_LIM"].factor == pytest.approx(180.0 / math.pi)
    assert units["RA_MAX_STR_ANG"].factor == 1.0
    assert all(parameter.factor > 0.0 for table in (PX4, ARDUPILOT) for parameter in table.parameters)
