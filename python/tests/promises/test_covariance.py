# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/promises/covariance.py`: what is reported of white and of correlated slip."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.promises.covariance import NOISES, Job, Row, measured_rows, sigmas
from benchmarks.promises.disturbed_robot import Disturbance, Robot, disturbed_run

SEEDS = range(12)


def row(noise: str, name: str) -> Row:
    """Learn logs of five minutes; return how far off slip rates are."""
    return measured_rows([Job(noise, name, 5.0, seed) for seed in SEEDS], workers=2)[-1]


def test_the_disturbance_of_slip_is_as_large_and_as_slow_as_given() -> None:
    calm = Robot(disturbance=Disturbance(0.0, 0.0), pose_std=(0.0, 0.0), wheel_std=0.0)
    slow = Robot(disturbance=NOISES["slow"], pose_std=(0.0, 0.0), wheel_std=0.0)
    fractions, products = [], []
    for seed in range(6):
        headings = [
            np.unwrap(disturbed_run(robot, 4.0, seed=seed).log.runs[0].poses.yaw) for robot in (calm, slow)
        ]
        (wheels,) = [run.wheels for run in disturbed_run(calm, 4.0, seed=seed).log.runs]
        assert wheels is not None
        turning = np.diff(headings[1] - headings[0])[: len(wheels.omega) - 1] * 20.0
        of_turn = turning / np.where(np.abs(wheels.omega[:-1]) > 0.3, wheels.omega[:-1], np.nan)
        fractions.append(np.nanstd(of_turn))
        products.append(np.nanmean(of_turn[100:] * of_turn[:-100]) / np.nanvar(of_turn))
    assert np.mean(fractions) == pytest.approx(0.15, rel=0.25)
    assert np.mean(products) == pytest.approx(np.exp(-1.0), abs=0.2)


def test_what_is_learned_of_a_log_is_judged_at_every_speed() -> None:
    off = sigmas(Job("both", "wheel", 2.0, 1))
    assert off.shape == (9, 3)
    assert np.isfinite(off).all()
    assert np.ptp(off) > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wheel", "command"])
def test_correlated_slip_is_reported(name: str) -> None:
    found = row("both", name)
    assert found.within_two >= 0.85, found
    assert found.beyond_three <= 0.05, found


@pytest.mark.slow
def test_white_noise_is_not_reported_as_more_than_it_is() -> None:
    found = row("white", "wheel")
    assert found.rms >= 0.65, found
    assert found.within_two >= 0.93, found
