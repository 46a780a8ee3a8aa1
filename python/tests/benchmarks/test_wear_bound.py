# SPDX-License-Identifier: Apache-2.0
"""The bound is that of a simulated test of slopes, and plain wear is found."""

from __future__ import annotations

import numpy as np
import pytest
from wear_bound import DAYS, VEHICLES, WEAR, alarms_of, best


@pytest.mark.parametrize("direction_known", [False, True])
def test_bound_is_what_a_limit_on_simulated_slopes_finds(*, direction_known: bool) -> None:
    random, sigma = np.random.default_rng(1), 0.004
    days = np.arange(DAYS) - 0.5 * (DAYS - 1)
    slopes = sigma * random.standard_normal((20000, VEHICLES, DAYS)) @ days / np.sum(days**2)
    seen = slopes if direction_known else np.abs(slopes)
    limit = np.quantile(seen.max(axis=1), 0.95)
    worn = slopes[:, 0] + WEAR / DAYS
    found = np.mean((worn if direction_known else np.abs(worn)) > limit)
    assert best(sigma, direction_known=direction_known) == pytest.approx(found, abs=0.01)


def test_wear_far_beyond_the_noise_is_found() -> None:
    assert ("robot-0", "drift") in alarms_of(np.random.default_rng(2), 0.004, 0.1)
