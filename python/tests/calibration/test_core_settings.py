# SPDX-License-Identifier: Apache-2.0
"""Settings reach the streaming learner, by the input and by the basis."""

from __future__ import annotations

import pytest

from slipwise.calibration import Settings, make_settings
from slipwise.calibration.core_settings import car_of, core_settings
from slipwise.errors import SettingsError

HORIZONS = (1.0, 2.0, 5.0)


def test_from_commands_lag_and_delay_are_learned_in_longer_segments() -> None:
    core = core_settings(Settings(), "command", HORIZONS)
    assert core.stream.from_commands
    assert core.hypotheses.dynamics
    assert core.stream.segment_length == 2.5
    wheels = core_settings(Settings(), "wheel", HORIZONS)
    assert not wheels.stream.from_commands
    assert not wheels.hypotheses.dynamics
    assert wheels.stream.segment_length == 1.0


def test_a_named_basis_is_learned_alone_and_by_way_of_the_wheels_too() -> None:
    named = core_settings(make_settings({"basis": "ipem-9"}), "command", HORIZONS).hypotheses
    assert [basis.name for basis in named.bases] == ["ipem-9"]
    assert (named.cascaded, named.direct, named.baseline) == (True, False, False)
    settings = make_settings({"basis": "ipem-9", "auto": {"structures": ["joint", "direct", "baseline"]}})
    assert not core_settings(settings, "command", HORIZONS).hypotheses.several


def test_an_unknown_basis_is_refused_before_anything_is_pushed() -> None:
    with pytest.raises(SettingsError, match="magic-7"):
        core_settings(make_settings({"basis": "magic-7"}), "wheel", HORIZONS)


@pytest.mark.parametrize("bases", [["ipem-9"], ["full-linear-6", "odd-even-10"], ["none", "edd-2"]])
def test_bases_that_are_chosen_are_those_of_a_car_too(bases: list[str]) -> None:
    settings = make_settings({"log": {"vehicle": "dart"}, "auto": {"bases": bases}})
    car = core_settings(settings, "command", HORIZONS, car=car_of(settings))
    assert [basis.name for basis in car.hypotheses.bases] == bases
    default = make_settings({"log": {"vehicle": "dart"}})
    fewer = core_settings(default, "command", HORIZONS, car=car_of(default)).hypotheses.bases
    assert 0 < len(fewer) < len(default.bases())


def test_branches_follow_changes_whether_surfaces_are_remembered_or_not() -> None:
    for remember in (False, True):
        assert core_settings(Settings(), "wheel", (1.0,), remember=remember).hypotheses.filter.branches.follow
