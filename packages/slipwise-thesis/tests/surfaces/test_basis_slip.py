# SPDX-License-Identifier: Apache-2.0
"""What the rows of a design determine, what they leave to the prior, and where channels stand in a basis."""

import numpy as np
import pytest

from slipwise import _core
from slipwise_thesis.surfaces.basis_slip import block_covariance, channel_designs, channel_slices, scaled_svd

BASIS = _core.named_basis("full-linear-6")


def test_the_channels_cover_all_parameters_once_in_order() -> None:
    places = [i for part in channel_slices(BASIS) for i in range(BASIS.size)[part]]
    assert places == list(range(BASIS.size))


def test_the_designs_give_the_slip_rates_of_the_core() -> None:
    v, omega = np.array([1.0, -0.5, 0.0]), np.array([0.3, 0.0, -0.8])
    alpha = np.linspace(-0.2, 0.3, BASIS.size)
    designs = channel_designs(BASIS, v, omega)
    slip = np.column_stack([d @ alpha[part] for d, part in zip(designs, channel_slices(BASIS), strict=True)])
    for i in range(len(v)):
        wanted = _core.slip_rate(BASIS, alpha, _core.SlipState(v[i], omega[i], 0.0, 0.0))
        np.testing.assert_allclose(slip[i], wanted, atol=1e-15)


def test_channels_that_are_learned_apart_share_no_covariance() -> None:
    blocks = [
        np.full((part.stop - part.start,) * 2, float(i + 1)) for i, part in enumerate(channel_slices(BASIS))
    ]
    covariance = block_covariance(BASIS, blocks)
    assert covariance.sum() == sum(block.sum() for block in blocks)
    lon, _, ang = channel_slices(BASIS)
    assert not covariance[lon, ang].any()


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_what_rows_determine_is_solved_and_the_rest_keeps_its_prior(rows: int) -> None:
    design = np.random.default_rng(rows).normal(size=(rows, 3))
    design[:, 2] = 2.0 * design[:, 1]  # the same but for a factor
    prior = np.array([0.5, 1.0, 0.2])
    inverse, rest = scaled_svd(design, prior)
    np.testing.assert_allclose(design @ inverse @ design, design, atol=1e-12)
    np.testing.assert_allclose(design @ rest, 0.0, atol=1e-12)
    rank = min(rows, 2)
    scaled = rest / np.outer(prior, prior)  # a projection, in units of the prior
    np.testing.assert_allclose(scaled @ scaled, scaled, atol=1e-12)
    assert np.trace(scaled) == pytest.approx(3 - rank)


def test_a_channel_without_terms_has_nothing_to_solve() -> None:
    inverse, rest = scaled_svd(np.zeros((4, 0)), np.zeros(0))
    assert inverse.shape == (0, 4)
    assert rest.shape == (0, 0)
