# SPDX-License-Identifier: Apache-2.0
"""Whether one of the bases that are averaged predicts better at the horizon than their average."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.statistics import held_out_half, ratio_of_means

Floats = NDArray[np.float64]

BETTER = 0.9  # of the average's error, from which on another basis is better
FEWEST = 10  # predictions of the held-out half; in fewer a tenth is chance
NO_SLIP = "none"


@dataclass(frozen=True)
class SimplerBasis:
    """A basis that predicts better than the average of all."""

    name: str
    position: float  # its mean error over the average's
    heading: float


def simpler_basis(bases: Sequence[str], model: _core.LearnedModel) -> SimplerBasis | None:
    """Return the basis that predicts better than the average by a tenth, beyond chance; None where none does.

    Args:
        bases: their names, as they were averaged.
        model: what a learner has learned.
    """
    position, heading = model.weighed_position, model.weighed_heading
    half = held_out_half(len(position))
    if half.stop - half.start < FEWEST or position.shape[1] != len(bases) + 1:
        return None
    found = []
    for k, name in enumerate(bases):
        ratios = [ratio_of_means(errors[half, k], errors[half, -1]) for errors in (position, heading)]
        better = any(value <= BETTER and high < 1.0 for value, _, high in ratios)
        if name != NO_SLIP and better and all(value <= 1.0 for value, _, _ in ratios):
            found.append(SimplerBasis(name, ratios[0][0], ratios[1][0]))
    return min(found, key=lambda each: each.position * each.heading, default=None)
