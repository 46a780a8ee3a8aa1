# SPDX-License-Identifier: Apache-2.0
"""Limits of commands: given, or those within which a model was learned."""

import math
from dataclasses import replace

import pytest
from sample_models import Made, make_model, named

from slipwise.errors import SettingsError
from slipwise.models.model import Model
from slipwise.planning.limits import ACCELERATION, DriveState, Limits, limits_of


def made(**changes: object) -> Made:
    return replace(named("edd-2"), **changes)  # type: ignore[arg-type]


def test_a_limit_that_is_no_positive_number_is_refused_by_name(subtests: pytest.Subtests) -> None:
    for name in ["speed", "yaw_rate", "curvature", "acceleration"]:
        for value in [0.0, -1.0, math.nan, math.inf]:
            with subtests.test(name=name, value=value):
                given = {"speed": 1.0, "yaw_rate": 1.0, "curvature": 1.0, "acceleration": 1.0, name: value}
                with pytest.raises(SettingsError, match=f"the limit {name} is"):
                    Limits(**given)


def test_limits_are_the_fastest_that_was_driven_either_way() -> None:
    limits = limits_of(make_model(made(speed=(-2.0, 1.5), yaw_rate=(-0.5, 0.8))))
    assert limits == Limits(speed=2.0, yaw_rate=0.8, curvature=0.8, acceleration=ACCELERATION)


def test_learned_limits_of_the_drive_are_kept_where_they_are_tighter() -> None:
    axes = {
        "speed": {"saturation": 1.1, "slew_rate_up": 0.4, "slew_rate_down": 1.7},
        "yaw_rate": {"saturation": 5.0},
    }
    limits = limits_of(make_model(made(speed=(0.0, 1.5), yaw_rate=(-1.0, 1.0), commands=True, limits=axes)))
    assert limits.speed == pytest.approx(1.1)
    assert limits.yaw_rate == pytest.approx(1.0)
    assert limits.acceleration == pytest.approx(0.4)


def test_a_model_that_never_turned_has_no_limits_of_its_own() -> None:
    with pytest.raises(SettingsError, match="without turning"):
        limits_of(make_model(made(yaw_rate=(0.0, 0.0))))


def test_a_start_that_is_not_finite_is_refused() -> None:
    assert DriveState(drive=(-1.0, 0.2), fast=(0.1, 0.0)).fast == (0.1, 0.0)
    for wrong in ({"drive": (math.nan, 0.0)}, {"commanded": (0.0, math.inf)}, {"fast": (math.nan, 0.0)}):
        with pytest.raises(SettingsError, match="not finite"):
            DriveState(**wrong)


def test_a_robot_that_steers_turns_no_tighter_than_it_did_or_at_full_speed() -> None:
    old = make_model(made(speed=(0.0, 2.0), yaw_rate=(-0.5, 0.5), commands=True, wheelbase=1.2))
    assert limits_of(old).curvature == pytest.approx(0.25)

    seen = old.content.model_copy(update={"range": old.content.range.model_copy(update={"curvature": 0.35})})
    assert limits_of(Model(seen)).curvature == pytest.approx(0.35)
