# SPDX-License-Identifier: Apache-2.0
"""The oracle of simulated visits has the covariance of the noise that it judges by."""

from __future__ import annotations

import numpy as np
import pytest
from surface_visits import NOISES, alike, oracle_right, pose_noise, second_covariances, second_means


@pytest.mark.parametrize("noise", ["white", "coloured"])
def test_means_of_seconds_scatter_as_their_covariance_says(noise: str) -> None:
    rng = np.random.default_rng(1)
    drawn = np.array([second_means(NOISES[noise](600, rng))[-10:] + pose_noise(10, rng) for _ in range(400)])
    for channel, stated in enumerate(second_covariances(noise, 10)):
        found = np.cov(drawn[:, :, channel].T)
        assert np.trace(found) == pytest.approx(np.trace(stated), rel=0.15)
        assert found.sum() == pytest.approx(stated.sum(), rel=0.25)


def test_the_surface_that_is_like_the_first_counts_as_it() -> None:
    assert alike(np.array([0, 1, 4])).tolist() == [0, 1, 0]


@pytest.mark.slow
def test_who_knows_surfaces_and_noise_is_right_on_a_short_visit() -> None:
    assert oracle_right("white", 8, 0.5, 1) == 1.0
