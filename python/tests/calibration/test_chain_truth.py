# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/chain_truth.py`: what is learned of known robots, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.chain_truth import NOT_SHOWN, Found, dull, from_commands, from_wheels_too

SEEDS = range(6)


def far_off(runs: list[list[Found]]) -> list[str]:
    """Parameters that miss by more than three stated standard deviations."""
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


def test_slip_offset_and_sensor_are_found_from_wheel_speeds() -> None:
    runs = [from_wheels_too(seed, 120.0) for seed in SEEDS]
    names = {"clock_offset", "sensor_x", "sensor_y", "sensor_yaw", "lon.V", "ang.w"}
    behind = [[found for found in run if found.name in names] for run in runs]
    assert {found.name for found in behind[0]} == names
    assert not far_off(behind)


@pytest.mark.parametrize("seed", range(3))
def test_a_dull_drive_says_what_it_does_not_show(seed: int) -> None:
    assert set(NOT_SHOWN) <= set(dull(seed))
