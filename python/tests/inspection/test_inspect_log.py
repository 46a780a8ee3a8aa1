# SPDX-License-Identifier: Apache-2.0
"""An inspection finds known delays, says what is not determined, and never fails on a readable log."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log, steady_run

from slipwise import open_log
from slipwise.inspection import inspect_log
from slipwise.logs import Log, empty_poses


@pytest.mark.parametrize("late", [0.0, 0.15, -0.1])
def test_a_known_clock_offset_is_found_within_its_uncertainty(late: float) -> None:
    inspection = inspect_log(simulated_log(Drive(seconds=180.0, late=late)))
    (offset,) = (timing for timing in inspection.timing if timing.name == "clock_offset")
    assert offset.determined
    assert offset.std < 0.02
    assert abs(offset.seconds - late) < 4.0 * offset.std


def test_a_known_delay_and_lag_of_commands_are_found_within_their_uncertainty() -> None:
    inspection = inspect_log(simulated_log(Drive(seconds=300.0, lag=0.5, delay=0.2)))
    found = {timing.name: timing for timing in inspection.timing if timing.input == "command"}
    for name, true in (("delay_v", 0.2), ("delay_omega", 0.2), ("lag_v", 0.5), ("lag_omega", 0.5)):
        assert found[name].determined
        assert abs(found[name].seconds - true) < max(4.0 * found[name].std, 0.03)


def test_straight_driving_does_not_determine_turning_and_the_advice_says_so() -> None:
    log = simulated_log(Drive(seconds=60.0, yaw_rates=(0.0, 1e-12)))
    (wheel,) = (item for item in inspect_log(log).learned if item.input == "wheel")
    determined = {p.name: p.determined for p in wheel.parameters}
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
    assert offset.determined
    assert 0.03 < offset.seconds < 0.35
    assert np.isfinite(offset.std)
