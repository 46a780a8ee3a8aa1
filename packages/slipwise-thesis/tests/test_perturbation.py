# SPDX-License-Identifier: Apache-2.0
"""The perturbative simulator drives as its slip surfaces say, and scatters as they state."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from slipwise import _core, predict
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs
from slipwise_sim import Perturbation, Scenario, Simulation, hold, simulate, thesis_drive
from slipwise_thesis import _thesis
from slipwise_thesis.surfaces import (
    LeastSquaresSurface,
    SlipExamples,
    SurfacePrediction,
    as_basis_model,
    slip_examples,
)

BASIS = _core.named_basis("odd-even-10")
ALPHA = np.array([-0.05, -0.02, -0.01, 0.03, -0.04, 0.01, -0.4, 0.05, 0.03, 0.01])
STILL = {"std_xy": 0.0, "std_yaw": 0.0}


def examples() -> SlipExamples:
    random = np.random.default_rng(5)
    drive = random.uniform((-1.0, -1.0), (2.0, 1.0), (300, 2))
    rates = [_core.slip_rate(BASIS, ALPHA, _core.SlipState(v, w, 0.0, 0.0)) for v, w in drive.tolist()]
    return slip_examples(drive, rates + random.normal(0.0, 0.02, (300, 3)))


@pytest.fixture(scope="module")
def surface() -> LeastSquaresSurface:
    fitted = LeastSquaresSurface(BASIS)
    fitted.fit(examples())
    return fitted


@dataclass(frozen=True)
class Flat:
    """A surface of one slip and one spread everywhere."""

    mean: tuple[float, float, float]
    std: tuple[float, float, float]
    notes: tuple[str, ...] = ()

    def fit(self, examples: SlipExamples) -> None:
        raise NotImplementedError

    def predict(self, v: ArrayLike, omega: ArrayLike) -> SurfacePrediction:
        rows = len(np.asarray(v))
        return SurfacePrediction(
            np.tile(self.mean, (rows, 1)), np.tile(self.std, (rows, 1)), np.full(3, np.inf)
        )


def end_poses(simulation: Simulation) -> NDArray[np.float64]:
    truth = simulation.truth
    return np.array([truth.x[-1], truth.y[-1], truth.yaw[-1]])


def test_without_noise_it_is_the_exact_prediction_of_the_surface(surface: LeastSquaresSurface) -> None:
    commands = thesis_drive(3, 30.0)
    quiet = Scenario(
        duration=30.0, commands=commands, perturbation=Perturbation(surface, spread=0.0), **STILL
    )
    run = simulate(quiet, seed=1).log.runs[0]
    path = predict(as_basis_model(surface, examples()), commands, horizon=30.0)
    at = np.searchsorted(run.poses.t, path.t - 1e-9)
    np.testing.assert_allclose(run.poses.x[at], path.poses[:, 0], atol=1e-9)
    np.testing.assert_allclose(run.poses.y[at], path.poses[:, 1], atol=1e-9)
    np.testing.assert_allclose(np.unwrap(run.poses.yaw[at]), path.poses[:, 2], atol=1e-9)


def test_many_drives_scatter_as_the_surface_states() -> None:
    slip, std, seconds = (-0.1, 0.05, -0.2), (0.03, 0.02, 0.04), 3.0
    scenario = Scenario(
        duration=4.0,
        commands=hold(1.0, 0.5, 4.0),
        perturbation=Perturbation(Flat(slip, std), segment=seconds),
        **STILL,
    )
    ends = np.array([end_poses(simulate(scenario, seed=seed)) for seed in range(400)])
    twist = _core.BodyTwist(1.0 + slip[0], slip[1], 0.5 + slip[2])
    noise = _thesis.SteadyNoise(np.square(std) * seconds, np.zeros(3), np.zeros(3))
    stated = np.array(_thesis.steady_covariance(twist, np.array([4.0]), noise))
    away = ends - np.array(_thesis.steady_path(twist, np.array([4.0])))[0]
    nees = np.einsum("ni,ij,nj->n", away, np.linalg.inv(stated), away)
    assert 2.6 < nees.mean() < 3.4  # 3 +- 3.3 standard errors
    np.testing.assert_allclose(
        np.cov(away.T) / np.sqrt(np.outer(np.diag(stated), np.diag(stated))),
        stated / np.sqrt(np.outer(np.diag(stated), np.diag(stated))),
        atol=0.25,
    )


def test_the_same_seed_gives_the_same_drive_and_another_another(surface: LeastSquaresSurface) -> None:
    scenario = Scenario(duration=5.0, perturbation=Perturbation(surface))
    first, again, other = (simulate(scenario, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.truth.x, again.truth.x)
    np.testing.assert_array_equal(first.log.runs[0].poses.yaw, again.log.runs[0].poses.yaw)
    assert not np.array_equal(first.truth.x, other.truth.x)
    assert first.log.notes == ("simulated: slip surfaces, 5 s, seed 1",)


def test_slip_noise_and_pose_noise_are_independent(surface: LeastSquaresSurface) -> None:
    scenario = Scenario(duration=60.0, commands=hold(1.0, 0.2, 60.0), perturbation=Perturbation(surface))
    run = simulate(scenario, seed=1)
    slip = np.diff(run.truth.x)
    pose = (run.log.runs[0].poses.x - run.truth.x)[:-1]
    assert abs(np.corrcoef(slip, pose)[0, 1]) < 0.1


def test_a_robot_told_to_stand_stands() -> None:
    commands = Inputs(np.array([1.0, 2.0]), np.array([1.0, 0.0]), np.zeros(2), np.zeros(2))
    scenario = Scenario(
        duration=4.0,
        commands=commands,
        perturbation=Perturbation(Flat((-0.1, 0.0, 0.1), (0.1, 0.1, 0.1))),
        **STILL,
    )
    truth = simulate(scenario, seed=1).truth
    assert not truth.x[truth.t <= 1.0].any()
    after = truth.t >= 2.0
    assert truth.x[-1] > 0.1
    assert np.ptp(truth.x[after]) == np.ptp(truth.yaw[after]) == 0.0


def test_wheels_do_as_they_are_told_and_commands_change_between_poses(surface: LeastSquaresSurface) -> None:
    commands = Inputs(np.array([0.0, 0.525]), np.array([1.0, 0.5]), np.zeros(2), np.zeros(2))
    quiet = Scenario(
        duration=1.0,
        commands=commands,
        perturbation=Perturbation(Flat((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),
        **STILL,
    )
    simulation = simulate(quiet, seed=1)
    assert simulation.truth.x[-1] == pytest.approx(0.525 + 0.5 * 0.475, abs=1e-12)
    wheels = simulation.log.runs[0].wheels
    assert wheels is not None
    np.testing.assert_allclose(wheels.v[[0, 10, 11, -1]], [1.0, 1.0, 0.5, 0.5], atol=1e-12)


@pytest.mark.parametrize(
    ("perturbation", "message"),
    [
        (Perturbation(Flat((0.0, 0.0, 0.0), (0.1, -0.1, 0.1))), "no mean with a spread there .V = 0.5"),
        (Perturbation(Flat((0.0, 0.0, 0.0), (np.inf, 0.1, 0.1))), "no mean with a spread"),
        (Perturbation(Flat((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), segment=0.0), "segment is 0.0"),
        (Perturbation(Flat((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), spread=-1.0), "spread is -1.0"),
    ],
)
def test_surfaces_that_cannot_drive_are_refused(perturbation: Perturbation, message: str) -> None:
    scenario = Scenario(duration=1.0, commands=hold(0.5, 0.0, 1.0))
    with pytest.raises(SettingsError, match=message):
        simulate(replace(scenario, perturbation=perturbation), seed=1)
