# SPDX-License-Identifier: Apache-2.0
"""How much the body does of what it is commanded, by slip and drive together."""

from dataclasses import replace

import numpy as np
import pytest
from sample_models import make_model, named

from slipwise.fleet.vehicle_numbers import vehicle_numbers
from slipwise.models.difference import differences
from slipwise.models.slip_words import slip_gains, whole_gains
from slipwise.models.summary import summarise
from slipwise.prediction import predict

HALF = replace(named("edd-2", lon__V=-0.1, ang__w=-0.4), response=True)


def test_slip_and_drive_together_are_known_as_well_as_their_product() -> None:
    model = make_model(HALF)
    names, covariance = model.table.names, model.table.covariance.copy()
    slip, drive = names.index("lon.V"), names.index("gain_v")
    covariance[np.ix_((slip, drive), (slip, drive))] = [[0.09, -0.09], [-0.09, 0.0901]]
    model = model.with_table(model.table.moved(model.table.values, covariance))
    assert slip_gains(model).speed.std == pytest.approx(0.3)
    whole = whole_gains(model).speed
    assert whole.value == pytest.approx(0.9 * 0.9)
    assert whole.std == pytest.approx(0.9 * 0.01, rel=1e-6)  # by itself each of them is unknown
    assert vehicle_numbers(model).drives == pytest.approx(0.81)
    (row,) = (row for row in differences(model, model) if row.name == "speed gain")
    assert row.first == (whole.value, whole.std)


def test_a_gain_in_front_of_limits_of_the_sides_is_part_of_what_the_body_does() -> None:
    made = replace(named("edd-2", lon__V=-0.1, ang__w=-0.4), commands=True)
    limited = make_model(replace(made, limits={"side": {"saturation": 1.2}}))
    for v, omega in ((0.5, 0.0), (0.0, 0.4)):
        poses = predict(limited, [(-60.0, v, omega)], horizon=1.0, start=0.0).poses
        done = (poses[-1, 0] - poses[0, 0]) / v if v else (poses[-1, 2] - poses[0, 2]) / omega
        gains = whole_gains(limited)
        assert (gains.speed if v else gains.yaw_rate).value == pytest.approx(done)
    assert vehicle_numbers(limited).drives == pytest.approx(1.1 * 0.9)
    assert vehicle_numbers(limited).turns == pytest.approx(0.9 * 0.6)
    said = " ".join(summarise(limited).sentences)
    assert "reach 110 % of the commanded speed and 90.0 % of" in said
