# SPDX-License-Identifier: Apache-2.0
"""An inspection finds known delays, says what is not determined, and never fails on a readable log."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log, steady_run

from slipwise import _core, open_log
from slipwise.calibration import calibrate
from slipwise.inspection import inspect_log
from slipwise.logs import Log, empty_poses


@pytest.mark.parametrize("late", [0.0, 0.15, -0.1])
def test_a_known_clock_offset_is_found_within_its_uncertainty(late: float) -> None:
    inspection = inspect_log(simulated_log(Drive(seconds=180.0, late=late)))
    (offset,) = (timing for timing in inspection.timing if timing.name == "clock_offset")
    assert offset.identifiable
    assert offset.std < 0.02
    assert abs(offset.seconds - late) < 4.0 * offset.std


def test_a_known_delay_and_lag_of_commands_are_found_within_their_uncertainty() -> None:
    inspection = inspect_log(simulated_log(Drive(seconds=300.0, lag=0.5, delay=0.2)))
    found = {timing.name: timing for timing in inspection.timing if timing.input == "command"}
    for name, true in (
        ("delay_v", 0.2),
        ("delay_omega", 0.2),
        ("time_constant_v", 0.5),
        ("time_constant_omega", 0.5),
    ):
        assert found[name].identifiable
        assert abs(found[name].seconds - true) < max(4.0 * found[name].std, 0.03)


def test_times_are_those_that_calibrate_finds() -> None:
    log = simulated_log(Drive(seconds=180.0, lag=0.4, delay=0.15, late=0.1))
    commanded = {(timing.input, timing.name): timing for timing in inspect_log(log).timing}
    assert len(commanded) == len(inspect_log(log).timing)
    for name in ("command", "wheel"):
        content = calibrate(log, input=name).model.content
        for parameter in content.parameters:
            timing = commanded.get((name, parameter.name.removeprefix("log_")))
            if timing is None or parameter.name == "clock_offset" != name:
                continue
            logarithm = parameter.name.startswith("log_")
            assert timing.seconds == (math.exp(parameter.value) if logarithm else parameter.value)
            assert timing.std == pytest.approx(parameter.std * (timing.seconds if logarithm else 1.0))
            assert timing.identifiable == parameter.identifiable
    assert {"delay_v", "time_constant_v"} <= {name for given, name in commanded if given == "command"}


def test_a_robot_that_obeys_at_once_has_delays_and_no_lag() -> None:
    slipping = Drive(seconds=120.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3))
    run = simulated_log(slipping).runs[0]
    log = Log(runs=(replace(run, wheels=None),))
    commanded = {timing.name: timing for timing in inspect_log(log).timing}
    assert set(commanded) == {"delay_v", "delay_omega"}
    assert abs(commanded["delay_v"].seconds) < 0.06
    assert "clock offset included" in commanded["delay_v"].meaning


def test_straight_driving_does_not_determine_turning_and_the_advice_says_so() -> None:
    log = simulated_log(Drive(seconds=60.0, yaw_rates=(0.0, 1e-12)))
    (wheel,) = (item for item in inspect_log(log).learned if item.input == "wheel")
    determined = {p.name: p.identifiable for p in wheel.parameters}
    assert determined["lon.V"]
    assert not determined["ang.w"]
    assert any("ang.w" in advice and "Turn" in advice for advice in wheel.advice)


def test_a_log_without_poses_says_what_is_missing() -> None:
    log = Log(runs=(replace(steady_run(20.0), poses=empty_poses()),))
    inspection = inspect_log(log)
    assert [item.missing.split(":")[0] for item in inspection.learned] == [
        "the log has no poses",
        "the log has no poses",
    ]
    assert inspection.timing == ()
    assert set(inspection.maps) == {"command", "wheel"}


def test_a_log_without_inputs_says_what_is_missing() -> None:
    log = Log(runs=(replace(steady_run(20.0), commands=None, wheels=None),))
    (item,) = inspect_log(log).learned
    assert item.missing.startswith("the log has no commands")


def test_a_parked_robot_is_inspected() -> None:
    (item, _) = inspect_log(Log(runs=(steady_run(20.0, v=0.0),))).learned
    assert item.missing.startswith("the robot never moves in this log")


def test_late_poses_of_a_real_log_are_seen(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "warthog" / "grass.csv.gz")
    (offset,) = (timing for timing in inspect_log(log).timing if timing.name == "clock_offset")
    assert offset.identifiable
    assert 0.03 < offset.seconds < 0.35
    assert np.isfinite(offset.std)


def test_poses_whose_heading_is_turned_are_said_with_the_option_that_cures_them() -> None:
    log = simulated_log(Drive(seconds=60.0, lag=0.1))
    turned = [replace(run, poses=replace(run.poses, yaw=run.poses.yaw + np.pi / 2)) for run in log.runs]
    assert inspect_log(log).learned[0].contradictions == ()
    found = inspect_log(replace(log, runs=tuple(turned))).learned[0].contradictions
    assert "turned by 90 deg" in found[0].sentence
    assert "--pose-yaw-offset -1.57" in found[0].advice[0]
