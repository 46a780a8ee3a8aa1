# SPDX-License-Identifier: Apache-2.0
"""Two models differ where their numbers lie further apart than both say they may."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from sample_models import LIMITS, make_model, named

from slipwise.errors import ModelError
from slipwise.models.difference import Difference, differences, same_logs, same_terms


def test_a_difference_is_measured_in_standard_deviations_of_both() -> None:
    assert Difference("a", "s", (1.0, 0.3), (2.0, 0.4)).z == pytest.approx(2.0)
    assert Difference("a", "s", (2.0, 0.0), (1.0, 0.0)).z == -math.inf
    assert Difference("a", "s", (1.0, 0.0), (1.0, 0.0)).z == 0.0
    missing = Difference("a", "s", None, (1.0, 0.1))
    assert math.isnan(missing.z)
    assert not missing.different


def test_only_what_lies_beyond_the_stated_uncertainty_differs() -> None:
    monday = replace(named("edd-2", lon__V=-0.05, ang__w=-0.4), commands=True)
    tuesday = replace(named("edd-2", lon__V=-0.06, ang__w=-0.3), commands=True)
    rows = {row.name: row for row in differences(make_model(monday), make_model(tuesday))}
    assert {name for name, row in rows.items() if row.different} == {"ang.w", "yaw-rate gain"}
    assert rows["ang.w"].z == pytest.approx(0.1 / math.hypot(0.01, 0.01))
    assert rows["delay_v"].unit == "s"
    assert rows["delay_v"].first == pytest.approx((0.2, 0.002))


def test_slip_terms_of_other_bases_are_not_compared_but_gains_are() -> None:
    simple, rich = make_model(named("edd-2", ang__w=-0.4)), make_model(named("full-linear-6", ang__w=-0.4))
    assert not same_terms(simple, rich)
    names = {row.name for row in differences(simple, rich)}
    assert names == {"speed gain", "yaw-rate gain", "separation multiplier"}


def test_a_delay_alone_and_a_lag_behind_one_are_compared_by_a_step() -> None:
    """Delays of 0.5 s and of 0.2 s before a lag of 0.3 s are no change of the robot."""
    delayed = make_model(replace(named("edd-2", ang__w=-0.4), delays=(0.5, 0.6)))
    lagging = make_model(replace(named("edd-2", ang__w=-0.4), commands=True))
    rows = {row.name: row for row in differences(delayed, lagging)}
    assert {name for name, row in rows.items() if row.different} == {"63 % of a step of yaw rate"}
    step = rows["63 % of a step of speed"]
    assert step.first == pytest.approx((0.5, 0.01))
    assert step.second == pytest.approx((0.5, 0.01 * math.hypot(0.2, 0.3)), rel=0.01)
    assert not {"delay_v", "ang.w"} & set(rows)


def test_slip_behind_a_gain_of_the_drive_is_compared_with_it() -> None:
    """A drive of 0.8 beside slip of 0.25, of which wheels tell, is a slip of 0.4 without wheels."""
    wheels = make_model(replace(named("edd-2", lon__V=-0.25, gain_v=0.8, gain_omega=1.0), response=True))
    alone = make_model(replace(named("edd-2", lon__V=-0.4), commands=True))
    rows = {row.name: row for row in differences(wheels, alone)}
    assert rows["speed gain"].first == pytest.approx((0.6, math.hypot(0.8 * 0.01, 0.75 * 0.01)))
    assert rows["speed gain"].second == pytest.approx((0.6, 0.01))
    assert "lon.V" not in rows


def test_a_limit_that_one_model_lacks_is_listed_without_a_z() -> None:
    made = replace(named("edd-2"), commands=True)
    rows = differences(make_model(made), make_model(replace(made, limits=LIMITS)))
    saturation = next(row for row in rows if row.name == "limits.speed.saturation")
    assert saturation.first is None
    assert saturation.second == (1.1, 0.01)


def test_models_of_different_inputs_cannot_be_compared() -> None:
    wheels, commands = named("edd-2"), replace(named("edd-2"), commands=True)
    with pytest.raises(ModelError, match="learned from wheels, the other from commands"):
        differences(make_model(wheels), make_model(commands))


def test_models_of_one_log_are_known_as_such() -> None:
    assert same_logs(make_model(named("edd-2")), make_model(named("icr-3")))
