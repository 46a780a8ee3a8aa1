# SPDX-License-Identifier: Apache-2.0
"""Attitudes in the field: in any turn, of a sensor on its side, in degrees; variances that cannot be."""

from __future__ import annotations

import warnings

import pytest
from sample_field import field_path, learned, share_errors

from slipwise.errors import LogError
from slipwise.logs import open_log


@pytest.mark.parametrize("name", ["roll_0_2pi_crash.csv", "imu_roll_90.mcap"])
def test_the_robot_is_learned_whatever_way_its_attitude_is_measured(name: str) -> None:
    found, said = learned(field_path(name))
    assert found.verdict.good
    assert max(map(abs, share_errors(found.model))) < 4.0
    assert ("about 90 deg of roll): this is taken out" in said) == name.startswith("imu")


def test_roll_and_pitch_in_degrees_are_named() -> None:
    with pytest.raises(LogError, match="roll and pitch look like degrees"):
        open_log(field_path("tilt_in_degrees.csv"))


def test_a_variance_that_cannot_be_is_not_known_and_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        log = open_log(field_path("cov_xy_1e308.mcap"))
    assert all(run.poses.std_xy is None for run in log.runs)
