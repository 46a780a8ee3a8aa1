# SPDX-License-Identifier: Apache-2.0
"""Slip rates against speed and curvature with their bars, on drawn groups and on simulated circles."""

from __future__ import annotations

import numpy as np
import pytest
from steady_paths import NOISE, PSD, SLIP, drawn_group

from slipwise_sim import Scenario, Simulation, hold, simulate
from slipwise_thesis.steady import (
    NoiseRules,
    PathRules,
    SlipFitRules,
    SteadyGroup,
    compare_fits,
    cut_paths,
    fit_group_noise,
    group_paths,
    slip_table,
)

POSE_STD = (0.01, 0.01, 0.003)  # of the simulated receiver
COMMANDS = ((0.5, 0.25), (1.0, 0.5))  # m/s, rad/s: curvature 0.5 1/m


@pytest.fixture(scope="module")
def circles() -> list[tuple[Simulation, SteadyGroup]]:
    found = []
    for seed, (v, omega) in enumerate(COMMANDS):
        simulation = simulate(Scenario(duration=50.0, commands=hold(v, omega, 50.0)), seed=seed)
        (run,) = simulation.log.runs
        assert run.commands is not None
        (group,) = group_paths(cut_paths(run, run.commands, PathRules(settle=3.0)).paths)
        found.append((simulation, group))
    return found


def test_bars_are_the_spread_of_one_segment_and_sigma_that_of_the_mean() -> None:
    (row,) = slip_table([drawn_group(seed=1, count=200)])
    assert row.segments == 200
    assert (row.v, row.curvature, row.omega) == (0.5, 0.5, 0.25)
    assert row.bar is not None
    np.testing.assert_allclose(row.bar, np.sqrt(PSD / 3.0), rtol=0.2)
    assert np.all(np.abs(np.array(row.slip) - SLIP) < 3.0 * np.array(row.sigma))
    assert max(row.sigma) < 0.3 * max(row.bar)


def test_small_groups_have_no_bar_and_single_segments_no_row_unless_the_noise_is_given() -> None:
    groups = [drawn_group(seed=seed, count=count) for seed, count in ((1, 1), (2, 2))]
    (row,) = slip_table(groups)
    assert row.bar is None
    assert len(slip_table(groups, SlipFitRules(noise=NOISE))) == 2


def test_circles_reach_two_metres_and_match_the_true_slip(
    circles: list[tuple[Simulation, SteadyGroup]],
) -> None:
    for simulation, group in circles:
        assert min(path.distance for path in group.paths) > 1.9
        (row,) = slip_table([group])
        truth = simulation.truth
        settled = truth.t > 3.0
        true_slip = [
            float(np.mean(column[settled])) - command
            for column, command in zip(
                (truth.vx, truth.vy, truth.omega), (group.v, group.vy, group.omega), strict=True
            )
        ]
        assert np.all(np.abs(np.array(row.slip) - true_slip) < 4.0 * np.array(row.sigma))


def test_yaw_slip_dominates_and_grows_with_speed(circles: list[tuple[Simulation, SteadyGroup]]) -> None:
    slow, fast = slip_table([group for _, group in circles])
    assert slow.slip[2] < -0.05
    assert fast.slip[2] / slow.slip[2] == pytest.approx(2.0, abs=0.2)  # figure 4.9: linear at one curvature


def test_figure_of_the_thesis_in_numbers(circles: list[tuple[Simulation, SteadyGroup]]) -> None:
    for _, group in circles:
        comparison = compare_fits(group)
        full, polynomial = comparison.curve("three channels"), comparison.curve("polynomial")
        assert comparison.curve("translation").cost > 50.0 * full.cost
        assert full.cost < 1.02 * polynomial.cost
        assert comparison.to_polynomial < 0.2 * comparison.translation_to_polynomial


def test_scatter_of_the_receiver_alone_is_not_taken_for_slip_noise_when_it_is_known(
    circles: list[tuple[Simulation, SteadyGroup]],
) -> None:
    groups = [group for _, group in circles]
    known = fit_group_noise(groups, NoiseRules(pose_std=POSE_STD))
    taken = fit_group_noise(groups)
    sigma = np.sqrt(np.diag(known.covariance))
    assert np.all(known.noise.psd < 3.0 * sigma[:3])
    assert np.all(np.abs(known.noise.start - np.array(POSE_STD) ** 2) < 4.0 * sigma[3:])
    assert np.all(taken.noise.psd > 1e-5)
