# SPDX-License-Identifier: Apache-2.0
"""Derivatives are those of the core's paths, and information makes predictions surer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.excitation import CommandSpace, Move, drawn_robots, prior_knowledge
from slipwise.excitation.information import (
    PoseStd,
    WorstPrediction,
    information,
    move_jacobians,
    prediction_jacobians,
    prior_information,
)
from slipwise.excitation.moves import command_periods

SPACE = CommandSpace(1.0, 1.0)
MOVE = Move(0.8, 0.6, 2.0, 0.5)
STEP = 1e-6


def test_derivative_is_the_difference_of_two_driven_paths() -> None:
    knowledge = prior_knowledge(SPACE)
    analytic = move_jacobians(knowledge, [MOVE])[0][0]
    for place in range(len(knowledge.mean)):
        ends = []
        for sign in (1.0, -1.0):
            mean = knowledge.mean.copy()
            mean[place] += sign * STEP
            robot = drawn_robots(replace(knowledge, mean=mean).spread_by(0.0), 1, seed=1)
            ends.append(robot.paths(command_periods([replace(MOVE, pause=0.0)], 0.1))[0, :, -1])
        numeric = (ends[0] - ends[1]) / (2.0 * STEP)
        np.testing.assert_allclose(analytic[:, place], numeric, atol=2e-5)


def test_standing_after_a_move_tells_lag_from_slip() -> None:
    with_lag, without = prior_knowledge(SPACE), prior_knowledge(SPACE, dynamics=False)
    assert [len(measured) for measured in move_jacobians(with_lag, [MOVE, MOVE])] == [2, 2]
    assert [len(measured) for measured in move_jacobians(without, [MOVE, MOVE])] == [1, 1]


def test_worst_prediction_is_that_of_the_least_sure_command() -> None:
    knowledge = prior_knowledge(SPACE, dynamics=False)
    jacobians = prediction_jacobians(knowledge, SPACE.grid(3), 2.0)
    known = prior_information(knowledge)
    yaw, position = WorstPrediction(jacobians).sigmas(known)
    covariances = jacobians @ knowledge.covariance @ np.swapaxes(jacobians, 1, 2)
    assert np.isclose(yaw**2, covariances[:, 2, 2].max())
    assert np.isclose(position**2, np.linalg.eigvalsh(covariances[:, :2, :2]).max())
    score = WorstPrediction(jacobians).scores(known[None])[0]
    assert np.isclose(score, np.log(yaw**2 * position**2))


def test_every_move_makes_the_worst_prediction_surer_or_leaves_it() -> None:
    knowledge = prior_knowledge(SPACE)
    judge = WorstPrediction(prediction_jacobians(knowledge, SPACE.grid(3), 2.0))
    known = prior_information(knowledge)
    before = judge.sigmas(known)
    for measured in move_jacobians(knowledge, [MOVE, Move(-0.5, 0.9, 2.0, 0.5)]):
        known = known + information(measured, PoseStd())
        after = judge.sigmas(known)
        assert after[0] <= before[0]
        assert after[1] <= before[1]
        before = after


def test_what_is_known_exactly_stays_known() -> None:
    knowledge = prior_knowledge(SPACE, dynamics=False)
    covariance = knowledge.covariance.copy()
    covariance[0] = covariance[:, 0] = 0.0
    known = prior_information(replace(knowledge, covariance=covariance))
    assert np.linalg.inv(known)[0, 0] < 1e-9
    np.testing.assert_allclose(np.linalg.inv(known)[1:, 1:], covariance[1:, 1:], atol=1e-12)
