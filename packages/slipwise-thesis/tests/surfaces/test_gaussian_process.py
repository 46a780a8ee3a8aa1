# SPDX-License-Identifier: Apache-2.0
"""The Gaussian process is Table 5.1's, follows a known surface, and refuses what it cannot hold."""

import logging
import math

import numpy as np
import pytest
from known_surface import draw, true_slip

pytest.importorskip("sklearn", reason="the Gaussian process needs scikit-learn")

from slipwise.errors import SettingsError
from slipwise_thesis.surfaces import GaussianProcessOptions, GaussianProcessSurface, slip_examples
from slipwise_thesis.surfaces.gaussian_process import spread_out

AT = (np.array([0.5, 1.0, 2.0]), np.array([-0.5, 0.0, 0.8]))


def test_it_is_the_algorithm_of_table_5_1_with_its_errata() -> None:
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    random = np.random.default_rng(1)
    x, test = random.uniform(-1.0, 1.0, (40, 2)), random.uniform(-1.0, 1.0, (7, 2))
    y = np.sin(3.0 * x[:, 0]) + x[:, 1] + 0.1 * random.standard_normal(40)
    noise, lengths = 0.01, np.array([0.5, 0.8])

    def k(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return 2.0 * np.exp(-0.5 * np.sum(np.square((a[:, None] - b[None]) / lengths), axis=2))

    lower = np.linalg.cholesky(k(x, x) + noise * np.eye(40))  # line 1: K + s^2 I
    alpha = np.linalg.solve(lower.T, np.linalg.solve(lower, y))  # line 2: L^T \ (L \ y)
    mean = k(test, x) @ alpha  # line 3
    v = np.linalg.solve(lower, k(x, test))  # line 4: L \ k*
    variance = 2.0 - np.sum(np.square(v), axis=0)  # line 5
    evidence = -0.5 * y @ alpha - np.log(np.diag(lower)).sum() - 20.0 * math.log(2.0 * math.pi)  # line 6
    kernel = ConstantKernel(2.0) * RBF(lengths) + WhiteKernel(noise)
    process = GaussianProcessRegressor(kernel, alpha=0.0, optimizer=None).fit(x, y)
    theirs, std = process.predict(test, return_std=True)
    np.testing.assert_allclose(theirs, mean, atol=1e-8)
    np.testing.assert_allclose(np.square(std) - noise, variance, atol=1e-8)
    assert process.log_marginal_likelihood_value_ == pytest.approx(evidence, abs=1e-8)


@pytest.mark.parametrize("kernel", ["rbf", "matern"])
def test_it_follows_a_known_surface(kernel: str) -> None:
    surface = GaussianProcessSurface(options=GaussianProcessOptions(kernel=kernel))  # type: ignore[arg-type]
    surface.fit(draw(120, 2))
    error = surface.predict(*AT).mean - true_slip(*AT)
    assert (np.abs(error) < [0.02, 0.02, 0.04]).all()
    assert len(surface.kernels) == 3


def test_far_from_all_examples_there_is_no_slip_and_much_doubt() -> None:
    surface = GaussianProcessSurface()
    surface.fit(draw(100, 3))
    far, near = surface.predict(1e6, 0.0), surface.predict(1.0, 0.0)
    assert np.abs(far.mean).max() < 1e-6
    assert (far.std > near.std).all()


def test_an_update_equals_a_fit_with_the_same_kernel() -> None:
    examples = draw(80, 4)
    grown = GaussianProcessSurface(options=GaussianProcessOptions(learn_kernel=False))
    grown.fit(examples[:60])
    whole = GaussianProcessSurface(options=GaussianProcessOptions(learn_kernel=False))
    whole.fit(examples[:60])
    grown.update(examples[60:])
    whole.fit(examples)
    np.testing.assert_allclose(grown.predict(*AT).mean, whole.predict(*AT).mean, atol=1e-12)


def test_twenty_thousand_examples_are_refused_or_thinned_aloud(caplog: pytest.LogCaptureFixture) -> None:
    examples = draw(20000, 5)
    with pytest.raises(SettingsError, match="too many for a Gaussian process"):
        GaussianProcessSurface().fit(examples)
    options = GaussianProcessOptions(thin=True, largest=200, shaped_by=80)
    surfaces = [GaussianProcessSurface(options=options) for _ in range(2)]
    with caplog.at_level(logging.WARNING):
        for surface in surfaces:
            surface.fit(examples)
    assert "uses 200 of 20000 examples" in caplog.text
    assert "uses 200 of 20000 examples" in surfaces[0].notes[0]
    np.testing.assert_array_equal(surfaces[0].predict(*AT).mean, surfaces[1].predict(*AT).mean)


@pytest.mark.parametrize("kind", ["one point", "duplicates", "one speed"])
def test_poor_examples_still_give_finite_answers(kind: str) -> None:
    examples = draw(20, 6)
    if kind == "one point":
        examples = examples[:1]
    if kind == "duplicates":
        examples = examples.joined(examples)
    if kind == "one speed":
        examples = slip_examples(np.column_stack((np.full(20, 1.5), examples.omega)), examples.slip)
    surface = GaussianProcessSurface()
    surface.fit(examples)
    prediction = surface.predict(*AT)
    assert np.isfinite(prediction.mean).all()
    assert (prediction.std > 0.0).all()


def test_points_are_spread_out_in_the_same_way_each_time_and_copies_come_last() -> None:
    points = np.array([[0.0, 0.0]] * 5 + [[1.0, 0.0], [0.0, 1.0], [5.0, 5.0]])
    assert {5, 6, 7} < set(spread_out(points, 4).tolist())
    assert len(set(spread_out(points, 6).tolist())) == 6
    np.testing.assert_array_equal(spread_out(points, 20), np.arange(8))
