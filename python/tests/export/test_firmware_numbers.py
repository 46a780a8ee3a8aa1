# SPDX-License-Identifier: Apache-2.0
"""Every quantity of the tables has an answer, and what is missing is said."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.export import ExportOptions
from slipwise.export.firmware_numbers import FirmwareNumbers, is_left
from slipwise.export.firmware_table import ARDUPILOT, PX4
from slipwise.export.measured_limits import Quantity

QUANTITIES = sorted({parameter.quantity for table in (PX4, ARDUPILOT) for parameter in table.parameters})
MADE = named("edd-2", ang__w=-0.4)


def test_every_quantity_is_a_number_or_says_why_not(subtests: pytest.Subtests) -> None:
    for quantity in QUANTITIES:
        for commands in [True, False]:
            with subtests.test(quantity=quantity, commands=commands):
                found = FirmwareNumbers(make_model(replace(MADE, commands=commands)), ExportOptions()).answer(
                    quantity
                )
                assert isinstance(found, Quantity) or len(found) > 10


def test_y_points_to_the_right_in_firmwares() -> None:
    assert is_left(-0.2)
    assert not is_left(0.2)


def test_a_feed_forward_says_which_number_it_needs() -> None:
    found = FirmwareNumbers(make_model(replace(MADE, commands=True)), ExportOptions()).answer("cruise_speed")
    assert isinstance(found, str)
    assert "--logged CRUISE_SPEED=VALUE" in found


def test_a_gain_that_no_parameter_scales_is_not_stated() -> None:
    made = Made(_core.Basis("none", [], [], []), commands=True)
    options = ExportOptions(logged={"ATC_STR_RAT_FF": 0.2})
    found = FirmwareNumbers(make_model(made), options).answer("steering_feed_forward")
    assert found == "the model has no parameter that scales the yaw rate"
