# SPDX-License-Identifier: Apache-2.0
"""The least-squares surface recovers a known law, states its spread, and names what it cannot know."""

import numpy as np
import pytest
from known_surface import ALPHA, BASIS, draw, noise_std, true_slip

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis.surfaces import LeastSquaresSurface, slip_examples


def test_it_recovers_the_parameters_within_three_sigma() -> None:
    surface = LeastSquaresSurface(BASIS)
    surface.fit(draw(400, 1))
    slip = surface.basis_slip()
    assert (np.abs(slip.alpha - ALPHA) < 3.5 * np.sqrt(np.diag(slip.covariance))).all()
    assert not surface.notes


def test_log_variance_follows_the_noise_and_the_thesis_form_reads_a_fifth_low() -> None:
    examples = draw(6000, 2)
    v, omega = np.array([0.8, 1.4, 2.0]), np.zeros(3)
    truth = noise_std(v)
    ratios = {}
    for spread in ("log-variance", "thesis"):
        surface = LeastSquaresSurface(BASIS, spread=spread)  # type: ignore[arg-type]
        surface.fit(examples)
        ratios[spread] = surface.predict(v, omega).std / truth
    assert np.abs(ratios["log-variance"] - 1.0).max() < 0.15
    assert ratios["thesis"][:, 0].mean() == pytest.approx(0.8, abs=0.1)


def test_the_thesis_spread_can_be_negative_and_log_variance_cannot() -> None:
    examples = draw(30, 3)
    grid = [axis.ravel() for axis in np.meshgrid(np.linspace(-2.5, 2.5, 21), np.linspace(-1.0, 1.0, 21))]
    least = {}
    for spread in ("log-variance", "thesis"):
        surface = LeastSquaresSurface(BASIS, spread=spread)  # type: ignore[arg-type]
        surface.fit(examples)
        least[spread] = surface.predict(*grid).std.min()
    assert least["thesis"] < 0.0 < least["log-variance"]


def test_one_speed_names_its_directions_and_is_unsure_elsewhere_only() -> None:
    omega = np.linspace(-1.0, 1.0, 20)
    v = np.full(20, 1.5)
    slip = true_slip(v, omega) + 0.01 * np.random.default_rng(4).standard_normal((20, 3))
    surface = LeastSquaresSurface(_core.named_basis("thesis-15"))
    surface.fit(slip_examples(np.column_stack((v, omega)), slip))
    assert "lon: V and V^2 cannot be distinguished" in surface.notes
    assert len(surface.notes) == 6
    assert np.isfinite(surface.predict(1.5, 0.3).std).all()
    assert np.isinf(surface.predict(1.0, 0.3).std).all()
    with pytest.raises(SettingsError, match="V and V\\^2 cannot be distinguished"):
        surface.basis_slip()


def test_one_point_is_refused_since_nothing_is_left_to_judge_noise_by() -> None:
    with pytest.raises(SettingsError, match="leave none to judge noise by"):
        LeastSquaresSurface(BASIS).fit(draw(1, 5))


def test_curvature_at_zero_speed_stays_finite() -> None:
    examples = draw(60, 6)
    turning = slip_examples(
        np.column_stack((np.append(examples.v, [0.0, 0.0]), np.append(examples.omega, [0.5, -0.5]))),
        np.vstack((examples.slip, np.zeros((2, 3)))),
    )
    surface = LeastSquaresSurface(_core.named_basis("thesis-15"))
    surface.fit(turning)
    prediction = surface.predict([0.0, 0.0], [0.5, 0.0])
    assert np.isfinite(prediction.mean).all()
    assert np.isfinite(prediction.std).all()
    assert (prediction.mean == 0.0).all()  # (5.1) knows no slip of a turn in place


def test_standard_deviations_weigh_the_examples() -> None:
    good, bad = draw(60, 7), draw(60, 8)
    spoiled = slip_examples(np.column_stack((bad.v, bad.omega)), bad.slip + 0.5, np.full((60, 3), 100.0))
    trusted = slip_examples(np.column_stack((good.v, good.omega)), good.slip, np.full((60, 3), 0.1))
    alone, together = LeastSquaresSurface(BASIS), LeastSquaresSurface(BASIS)
    alone.fit(trusted)
    together.fit(trusted.joined(spoiled))
    np.testing.assert_allclose(together.basis_slip().alpha, alone.basis_slip().alpha, atol=1e-4)


def test_it_must_be_fitted_before_it_predicts() -> None:
    with pytest.raises(SettingsError, match="learned nothing"):
        LeastSquaresSurface(BASIS).predict(1.0, 0.0)
