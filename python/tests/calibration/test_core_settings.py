# SPDX-License-Identifier: Apache-2.0
"""Settings reach the streaming learner, by the input and by the basis."""

from __future__ import annotations

import pytest

from slipwise import _core
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


def test_segments_are_cut_as_those_of_other_methods_are() -> None:
    settings = make_settings(
        {"segment": {"length": 3.0, "unknown_after": 0.3}, "sensor_extrinsics": {"x": 0.4, "yaw": 0.2}}
    )
    stream = core_settings(settings, "wheel", HORIZONS).stream
    assert (stream.segment_length, stream.unknown_after) == (3.0, 0.3)
    assert stream.sensor.vector().tolist() == [0.4, 0.0, 0.2]
    assert stream.horizons == [1.0, 2.0, 5.0]
    assert stream.whole_frames  # a frame that is shorter than a segment is learned too
    assert stream.stride is None
    rules = _core.SegmentRules()
    for name in ("late_factor", "length_tolerance", "still_speed"):
        assert getattr(stream.rules, name) == getattr(rules, name)


def test_the_basis_auto_tries_the_structures_that_the_settings_name() -> None:
    tried = core_settings(Settings(), "command", HORIZONS).hypotheses
    assert (tried.cascaded, tried.direct, tried.baseline, tried.several) == (True, True, True, True)
    assert [basis.name for basis in tried.bases] == Settings().auto.bases
    joint = make_settings({"auto": {"structures": ["joint"], "bases": ["edd-2"]}})
    alone = core_settings(joint, "command", HORIZONS).hypotheses
    assert (alone.cascaded, alone.direct, alone.baseline, alone.several) == (False, False, False, False)
    assert [basis.name for basis in alone.bases] == ["edd-2"]


def test_a_named_basis_is_learned_alone_whatever_structures_are_named() -> None:
    core = core_settings(make_settings({"basis": "ipem-9"}), "command", HORIZONS)
    assert [basis.name for basis in core.hypotheses.bases] == ["ipem-9"]
    assert not core.hypotheses.several


@pytest.mark.parametrize(
    ("content", "reached"),
    [
        ({"learn_clock_offset": False}, lambda core: core.hypotheses.clock_offset),
        ({"slip_disturbance": {"learn": False}}, lambda core: core.learn_disturbance),
        ({"change": {"detect": False}}, lambda core: core.hypotheses.average.change.detect),
        ({"noise": {"adapt": False}}, lambda core: core.hypotheses.filter.noise.adapt),
    ],
)
def test_what_is_switched_off_is_off_in_the_core(content: dict[str, object], reached: object) -> None:
    assert callable(reached)
    assert reached(core_settings(Settings(), "wheel", HORIZONS)) is True
    assert reached(core_settings(make_settings(content), "wheel", HORIZONS)) is False


def test_the_pose_of_the_sensor_is_learned_only_where_that_is_asked() -> None:
    assert not core_settings(Settings(), "wheel", HORIZONS).hypotheses.sensor_extrinsics
    learned = make_settings({"sensor_extrinsics": {"x": 1.0, "learn": True}})
    core = core_settings(learned, "wheel", HORIZONS)
    assert core.hypotheses.sensor_extrinsics
    assert core.hypotheses.filter.prior.sensor.vector().tolist() == [1.0, 0.0, 0.0]


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
