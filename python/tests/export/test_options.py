# SPDX-License-Identifier: Apache-2.0
"""Numbers of a robot that make no sense are refused, with the option and what would make sense."""

import math

import pytest

from slipwise.errors import SettingsError
from slipwise.export.options import ExportOptions


def test_the_defaults_and_the_bounds_themselves_are_taken() -> None:
    assert ExportOptions().wheel_separation is None
    assert ExportOptions(horizon=1000.0, wheel_separation=0.001).horizon == 1000.0


def test_a_number_out_of_bounds_is_refused_with_its_option(subtests: pytest.Subtests) -> None:
    for name, advice in [
        ("horizon", "give 0.01 to 1000 s"),
        ("wheel_separation", "give 0.001 to 100 m"),
        ("logged_separation_multiplier", "give 0.01 to 100"),
        ("logged_radius_multiplier", "give 0.01 to 100"),
        ("min_turning_radius", "give 0.001 to 10000 m"),
        ("update_rate", "give 0.1 to 100000 Hz"),
        ("planning_horizon", "give 0.01 to 1000 s"),
        ("filter_rate", "give 0.1 to 100000 Hz"),
    ]:
        for value in [0.0, -1.0, 1e300, math.nan, math.inf]:
            with subtests.test(name=name, advice=advice, value=value):
                with pytest.raises(SettingsError) as caught:
                    ExportOptions(**{name: value})
                assert f"--{name.replace('_', '-')}" in str(caught.value)
                assert str(caught.value).rstrip(".").endswith(advice)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("RO_YAW_RATE_COR", 1.2, "nothing follows from RO_YAW_RATE_COR .*RO_YAW_RATE_CORR"),
        ("RO_YAW_RATE_CORR", 0.0, "RO_YAW_RATE_CORR was 0 .*give a positive number"),
        ("ATC_STR_RAT_FF", -0.2, "give a positive number"),
        ("WENC_POS_Y", math.nan, "give a finite number"),
    ],
)
def test_what_was_logged_has_a_name_that_is_read_and_a_number_that_scales(
    name: str, value: float, message: str
) -> None:
    assert ExportOptions(logged={"WENC_POS_Y": -0.2, "steering_offset": 0.0}).logged
    with pytest.raises(SettingsError, match=message):
        ExportOptions(logged={name: value})
