# SPDX-License-Identifier: Apache-2.0
"""Held-out scores of the three surfaces, and the probabilities they rest on."""

import numpy as np
import pytest
from known_surface import BASIS, draw, noise_std

from slipwise import _core
from slipwise_thesis.surfaces import (
    LEVELS,
    BayesianSurface,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipSurface,
    score_surface,
    slip_examples,
)
from slipwise_thesis.surfaces.scores import central_probability

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("z", "freedom", "probability"),
    [
        (12.7062, 1.0, 0.95),
        (4.3027, 2.0, 0.95),
        (2.2622, 9.0, 0.95),
        (0.6745, np.inf, 0.5),
        (1.9842, 97.0, 0.95),
    ],
)
def test_central_probabilities_are_those_of_the_tables(z: float, freedom: float, probability: float) -> None:
    assert central_probability(np.array([z]), freedom)[0] == pytest.approx(probability, abs=1e-4)


@pytest.mark.parametrize("name", ["least-squares", "bayesian", "gaussian-process"])
def test_held_out_coverage_is_as_stated_and_the_log_score_near_the_best(name: str) -> None:
    surface: SlipSurface
    if name == "gaussian-process":
        pytest.importorskip("sklearn", reason="the Gaussian process needs scikit-learn")
        surface = GaussianProcessSurface()
    else:
        surface = LeastSquaresSurface(BASIS) if name == "least-squares" else BayesianSurface(BASIS)
    surface.fit(draw(300, 1))
    held_out = draw(1000, 2)
    score = score_surface(surface, held_out)
    # Noise that grows with speed is not Gaussian of one size: the two others are allowed more.
    assert np.abs(score.coverage - np.array(LEVELS)[:, None]).max() < (
        0.06 if name == "least-squares" else 0.09
    )
    best = -np.log(noise_std(held_out.v)).mean(axis=0) - 0.5 * np.log(2.0 * np.pi) - 0.5
    assert (score.log_score > best - (0.08 if name == "least-squares" else 0.15)).all()
    assert (score.log_score < best + 0.08).all()


def test_what_is_not_determined_scores_minus_infinity() -> None:
    examples = draw(50, 3)
    surface = LeastSquaresSurface(_core.named_basis("full-linear-6"))
    straight = slip_examples(np.column_stack((examples.v, np.zeros(50))), examples.slip)
    surface.fit(straight)
    assert np.isfinite(score_surface(surface, straight).log_score).all()
    assert (score_surface(surface, examples).log_score == -np.inf).all()
