# SPDX-License-Identifier: Apache-2.0
"""The Bayesian surface learns on-line, forgets, merges, and says how sure it is."""

import numpy as np
import pytest
from known_surface import ALPHA, BASIS, draw

from slipwise.errors import SettingsError
from slipwise_thesis.surfaces import (
    BayesianOptions,
    BayesianSurface,
    LeastSquaresSurface,
    SlipExamples,
    slip_examples,
)

AT = (np.array([0.5, 1.0, 2.0]), np.array([-0.5, 0.0, 0.8]))
GIVEN = BayesianOptions(reference=(2.0, 0.8))


def same(a: BayesianSurface, b: BayesianSurface, tolerance: float = 1e-9) -> None:
    one, other = a.predict(*AT), b.predict(*AT)
    np.testing.assert_allclose(one.mean, other.mean, atol=tolerance)
    np.testing.assert_allclose(one.std, other.std, rtol=1e-8)
    np.testing.assert_array_equal(one.freedom, other.freedom)


def fitted(examples: SlipExamples, options: BayesianOptions = GIVEN) -> BayesianSurface:
    surface = BayesianSurface(BASIS, options=options)
    surface.fit(examples)
    return surface


def test_it_recovers_the_parameters_within_three_sigma() -> None:
    slip = fitted(draw(400, 1)).basis_slip()
    assert (np.abs(slip.alpha - ALPHA) < 3.5 * np.sqrt(np.diag(slip.covariance))).all()


def test_many_examples_make_it_least_squares() -> None:
    examples = draw(20000, 2)
    other = LeastSquaresSurface(BASIS)
    other.fit(examples)
    np.testing.assert_allclose(fitted(examples).predict(*AT).mean, other.predict(*AT).mean, atol=1e-4)


def test_one_by_one_is_all_at_once_and_removal_takes_it_back() -> None:
    examples, more = draw(50, 3), draw(5, 4)
    surface = BayesianSurface(BASIS, options=GIVEN)
    for place in range(len(examples)):
        surface.update(examples[place : place + 1])
    same(surface, fitted(examples))
    surface.update(more)
    surface.remove(more)
    same(surface, fitted(examples))


def test_what_was_never_learned_cannot_be_removed_and_nothing_changes() -> None:
    surface = fitted(draw(20, 5))
    far = slip_examples([[50.0, 20.0]], [[1.0, 1.0, 1.0]])
    with pytest.raises(SettingsError, match="was it added"):
        surface.remove(far)
    same(surface, fitted(draw(20, 5)))


def test_a_window_knows_its_latest_examples_alone() -> None:
    examples = draw(300, 6)
    options = BayesianOptions(reference=(2.0, 0.8), window=40)
    surface = fitted(examples, options)
    same(surface, fitted(examples[-40:]))
    with pytest.raises(SettingsError, match="forgets by itself"):
        surface.remove(examples[-1:])


def test_two_surfaces_merged_know_what_one_of_all_examples_knows() -> None:
    first, second = draw(30, 7), draw(45, 8)
    same(fitted(first).merged(fitted(second)), fitted(first.joined(second)))
    with pytest.raises(SettingsError, match="same prior"):
        fitted(first).merged(fitted(second, BayesianOptions(reference=(1.0, 0.8))))


def test_known_noise_is_the_thesis_and_gaussian() -> None:
    options = BayesianOptions(reference=(2.0, 0.8), noise_examples=np.inf)
    prediction = fitted(draw(2000, 9), options).predict(*AT)
    assert np.isinf(prediction.freedom).all()
    np.testing.assert_allclose(
        prediction.std[:, 0], 0.01 * 2.0, rtol=0.01
    )  # its own noise, whatever the examples say


def test_one_point_and_one_speed_leave_the_prior_and_say_so() -> None:
    surface = fitted(draw(1, 10))
    assert any(note.endswith("but by the prior") for note in surface.notes)
    assert np.isfinite(surface.predict(*AT).std).all()


def test_learning_on_line_needs_reference_speeds() -> None:
    with pytest.raises(SettingsError, match="learned nothing"):
        BayesianSurface(BASIS).update(draw(1, 11))
