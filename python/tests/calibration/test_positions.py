# SPDX-License-Identifier: Apache-2.0
"""Learning from positions without headings: true within its own uncertainty, live as from a log."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_noise import lasting_noise
from sample_positions import ANTENNA, BASIS, HORIZONS, SECONDS, SETTINGS, SLIP, commands

from slipwise.calibration import Settings, calibrate
from slipwise.calibration.coming import Coming
from slipwise.calibration.core_settings import STRAIGHT_SIDE_SLIP, core_settings
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import SettingsError
from slipwise.logs import Log
from slipwise.student import fraction_inside
from slipwise_sim.known_robot import KnownRobot, known_run

Floats = NDArray[np.float64]


def positions_log(seed: int, *, drift: float = 0.0) -> Log:
    random = np.random.default_rng(seed)
    robot = KnownRobot(lag=(0.2, 0.3), delay=(0.1, 0.15), basis=BASIS, slip=SLIP, sensor=ANTENNA)
    run = known_run(robot, commands(random), (0.0, SECONDS), random=random)
    apart = drift * lasting_noise(run.poses.t, 10.0, random, 2)
    poses = replace(run.poses, x=run.poses.x + apart[:, 0], y=run.poses.y + apart[:, 1], course=True)
    return Log(runs=(replace(run, poses=poses),))


def slip_errors(log: Log, input_name: str) -> tuple[Floats, Floats, float]:
    """Errors over their standard deviations, these, and the part of predictions inside 95 % ellipsoids."""
    learned = learn_log(prepare_run(log, input_name), SETTINGS, HORIZONS)
    error = learned.kept.mean[:6] - SLIP
    std = np.sqrt(np.diag(learned.kept.covariance))[:6]
    first = learned.predictions[0]
    apart = first.measured - first.pose
    apart[:, 2] = np.angle(np.exp(1j * apart[:, 2]))
    squares = np.einsum("ni,ni->n", apart, np.linalg.solve(first.covariance, apart[..., None])[..., 0])
    inside = [fraction_inside(square, dof) < 0.95 for square, dof in zip(squares, first.dof, strict=True)]
    return error / std, std, float(np.mean(inside))


@pytest.mark.slow
@pytest.mark.parametrize(("input_name", "drift"), [("wheel", 0.0), ("wheel", 0.3), ("command", 0.0)])
def test_slip_is_true_within_its_uncertainty_with_white_and_with_drifting_positions(
    input_name: str, drift: float
) -> None:
    found = [slip_errors(positions_log(seed, drift=drift), input_name) for seed in range(8)]
    z, std = np.array([each[0] for each in found]), np.array([each[1] for each in found])
    assert np.abs(z).max() < 4.0
    assert np.sqrt(np.mean(z**2, axis=0)).max() < 1.7
    assert 0.85 < np.mean([each[2] for each in found]) <= 1.0
    turning, side_slip = std[:, 5].mean(), std[:, 3].mean()
    assert turning < (0.04 if drift else 0.02)
    assert side_slip < (0.08 if drift else 0.03)
    assert std[:, 2] == pytest.approx(STRAIGHT_SIDE_SLIP, rel=0.05)  # nothing is claimed to be known of it


def test_a_learner_of_poses_refuses_positions() -> None:
    with pytest.raises(SettingsError, match="positions=True"):
        MotionLearner("wheel").push_position(0.0, 0.0, 0.0)


def test_without_positions_no_prior_changes() -> None:
    plain = core_settings(Settings(), "wheel", HORIZONS)
    assert plain.hypotheses.filter.prior.straight_side_slip_std is None
    with_positions = core_settings(Settings(), "wheel", HORIZONS, coming=Coming(positions=True))
    assert with_positions.hypotheses.filter.prior.straight_side_slip_std == STRAIGHT_SIDE_SLIP


def test_evaluations_and_inspections_say_that_only_positions_were_measured() -> None:
    from slipwise.cli.evaluation_verdict import verdict_on
    from slipwise.evaluation import EvaluationOptions, evaluate
    from slipwise.inspection.learnability import learnability_of

    log = positions_log(2)
    learnable = learnability_of(log, "wheel", SETTINGS)
    assert learnable.advice[0].startswith("Only positions were measured")
    assert not any("lat.V)" in text for text in learnable.advice)
    calibration = calibrate(log, settings=SETTINGS, input="wheel")
    options = EvaluationOptions(methods=("none", "full-linear-6"), horizons=(1.0,))
    verdict = verdict_on(evaluate(log, settings=SETTINGS, input="wheel", options=options), calibration)
    assert verdict is not None
    assert "Only positions were measured" in verdict.sentence
