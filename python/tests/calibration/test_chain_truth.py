# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/actuator_truth.py`: what is learned of known robots, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.actuator_truth import NOT_SHOWN, Found, dull, from_commands, from_wheels_too

SEEDS = range(6)


def far_off(runs: list[list[Found]]) -> list[str]:
    """Parameters that miss by more than three reported standard deviations."""
    return [f"{found.name}: {found.sigmas:.1f}" for run in runs for found in run if abs(found.sigmas) > 3.0]


@pytest.fixture(scope="module")
def from_commands_alone() -> list[list[Found]]:
    return [from_commands(seed, 120.0) for seed in SEEDS]


def test_chain_slip_and_sensor_are_found_from_commands(from_commands_alone: list[list[Found]]) -> None:
    count = sum(len(run) for run in from_commands_alone)
    assert len(far_off(from_commands_alone)) <= 0.05 * count, far_off(from_commands_alone)


def test_much_was_learned_of_every_parameter(from_commands_alone: list[list[Found]]) -> None:
    for rows in zip(*from_commands_alone, strict=True):
        assert np.median([row.std / row.prior_std for row in rows]) < 0.5, rows[0].name


def test_all_is_found_in_cascade_and_as_surely_as_stated() -> None:
    runs = [from_wheels_too(seed) for seed in SEEDS]
    assert {"clock_offset", "sensor_x", "lon.V", "slow_fraction_v", "log_delay_omega"} <= {
        f.name for f in runs[0]
    }
    assert len(far_off(runs)) <= 0.03 * sum(len(run) for run in runs), far_off(runs)
    actuator = [f for run in runs for f in run if f.name.endswith(("_v", "_omega"))]
    assert 0.4 < np.sqrt(np.mean([f.sigmas**2 for f in actuator])) < 1.5
    assert np.median([f.std / f.prior_std for f in actuator]) < 0.05


@pytest.mark.parametrize("rate", [10.0, 50.0])
def test_a_wheel_speed_that_holds_until_the_next_is_no_delay(rate: float) -> None:
    found = {f.name: f for f in from_wheels_too(0, rate=rate)}
    delays = [found[f"log_delay_{channel}"] for channel in ("v", "omega")]
    assert all(f.std < 0.1 for f in delays), delays
    assert not far_off([[*delays, found["clock_offset"]]])


@pytest.mark.parametrize("seed", range(3))
def test_a_dull_drive_says_what_it_does_not_show(seed: int) -> None:
    assert set(NOT_SHOWN) <= set(dull(seed))
