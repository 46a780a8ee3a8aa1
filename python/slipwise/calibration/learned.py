# SPDX-License-Identifier: Apache-2.0
"""What learning gave: what a model file holds of it, and what it is judged by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.judgement import FEWEST_WINDOWS
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import History
from slipwise.calibration.source_knowledge import LearnedSource
from slipwise.models import schema


@dataclass(frozen=True, eq=False)
class Learned:
    """What learning gave."""

    kept: Posterior
    identifiable: Posterior  # the same; of the next best where the baseline is kept, which has no parameters
    predictions: tuple[Predictions, ...]  # causal, of the horizons that are judged
    baseline: tuple[Predictions, ...]  # the kinematic baseline's, of the same segments
    students: dict[float, schema.StudentT]
    history: History | None
    bases: tuple[str, ...]
    limits: _core.LimitSearch | None = None  # what a search found, whether kept or not
    car: _core.CarCurves | None = None  # where commands are throttle and steering
    sources: tuple[LearnedSource, ...] = ()  # of poses, where there are several
    body: schema.MeasuredBody | None = None  # what the poses show of its rates
    evidence: _core.MotionEvidence | None = None  # of contradictions, where a learner took the measurements
    again: NDArray[np.float64] | None = None  # errors of what is kept over the last segments judged, [N, 2]

    @property
    def judged(self) -> int:
        """Which of the horizons is judged: the longest one with enough predictions."""
        return judged_horizon([len(predictions) for predictions in self.predictions])


def judged_horizon(counts: Sequence[int]) -> int:
    """Return which horizon is judged, of `counts` predictions each: the longest one with enough of them."""
    enough = [k for k, count in enumerate(counts) if count >= 2 * FEWEST_WINDOWS]
    some = [k for k, count in enumerate(counts) if count]
    return enough[-1] if enough else (some or [0])[0]
