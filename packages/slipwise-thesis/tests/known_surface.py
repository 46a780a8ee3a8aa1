# SPDX-License-Identifier: Apache-2.0
"""A known slip law, and examples drawn from it with noise that grows with speed."""

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise_thesis.surfaces import SlipExamples, slip_examples

BASIS = _core.named_basis("odd-even-10")
ALPHA = np.array([-0.05, -0.02, -0.01, 0.03, -0.04, 0.01, -0.4, 0.05, 0.03, 0.01])


def true_slip(v: NDArray[np.float64], omega: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array(
        [
            _core.slip_rate(BASIS, ALPHA, _core.SlipState(a, b, 0.0, 0.0))
            for a, b in zip(v.tolist(), omega.tolist(), strict=True)
        ]
    )


def noise_std(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack([0.01 + 0.01 * v, 0.005 + 0.005 * v, 0.02 + 0.02 * v])


def draw(count: int, seed: int) -> SlipExamples:
    random = np.random.default_rng(seed)
    v, omega = random.uniform(0.3, 2.5, count), random.uniform(-1.0, 1.0, count)
    slip = true_slip(v, omega) + noise_std(v) * random.standard_normal((count, 3))
    return slip_examples(np.column_stack((v, omega)), slip)
