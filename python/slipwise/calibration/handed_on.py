# SPDX-License-Identifier: Apache-2.0
"""Whether the model that is handed on is the one that was judged: it predicts the last segments again.

The verdict's figures are of a learner that goes on learning and follows slip that lasts; a file holds what it
knew at its end, which may be of another ground, of a robot that was stopped, or a worse answer of the drive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import held_out_half
from slipwise.number_text import number_text

Floats = NDArray[np.float64]

_FEWEST = 4  # segments
_TIMES = 1.5  # as large an error, from which on it is said
_SHOWS = (0.05, 0.01)  # of the motion, and at least so many m or rad; smaller errors are nobody's concern
_STOPPED = "does-not-move"
_ADVICE = (
    "Let it go on learning on the robot (slipwise live), or learn the ground that the model is for alone "
    "(--start and --end)."
)


@dataclass(frozen=True)
class HandedOn:
    """Mean errors over the same segments: position [m] and heading [rad] each."""

    again: tuple[float, float]  # of the model as it is handed on
    judged: tuple[float, float]  # of the learner, before it learned each
    baseline: tuple[float, float]
    motion: tuple[float, float]  # how far the robot moved and turned
    horizon: float  # s

    @property
    def larger(self) -> dict[str, float]:
        """How many times as large its errors are, of those that are clearly larger: position, heading."""
        share, least = _SHOWS
        found = {}
        for name, again, judged, motion in zip(
            ("position", "heading"), self.again, self.judged, self.motion, strict=True
        ):
            if again > max(_TIMES * judged, share * motion, least):
                found[name] = again / judged if judged > 0.0 else np.inf
        return found

    def fault(self, kinds: set[str]) -> str:
        """Say why no such model is to be used: a robot that does not move was learned last; else empty."""
        beaten = any(
            again > baseline and name in self.larger
            for name, again, baseline in zip(("position", "heading"), self.again, self.baseline, strict=True)
        )
        if _STOPPED not in kinds or not beaten:
            return ""
        return (
            "it was learned last while the robot did not move although it was driven, and misses what was "
            f"driven before by {self._figures(self.again)} after {self.horizon:g} s, the kinematic baseline "
            f"by {self._figures(self.baseline)}"
        )

    def sentence(self) -> str:
        """Say how much worse it is than what was judged; empty where it is not."""
        if not self.larger:
            return ""
        times = " and ".join(
            f"its {name} error {number_text(value, 2)}" for name, value in self.larger.items()
        )
        return (
            f"As it is at the end, it misses the last segments by {self._figures(self.again)}: {times} times "
            "as large as that of the learner on the way, which follows slip that changes."
        )

    def advice(self) -> tuple[str, ...]:
        """Say what to do about it."""
        if not self.larger:
            return ()
        return (_ADVICE,)

    @staticmethod
    def _figures(errors: tuple[float, float]) -> str:
        return f"{errors[0]:.3g} m and {errors[1]:.3g} rad"


def handed_on(learned: Predictions, baseline: Predictions, again: Floats) -> HandedOn | None:
    """Compare a model as it is handed on with what was predicted on the way.

    Args:
        learned: of the learner, at the horizon that is judged.
        baseline: the kinematic baseline's, of the same segments.
        again: errors of the model over the last of these segments, [N, 2]: position [m], heading [rad].

    Returns:
        None where there are fewer than four segments.
    """
    half = held_out_half(len(learned))
    count = min(len(again), half.stop - half.start)
    if count < _FEWEST:
        return None
    errors = again[-count:].mean(axis=0)

    def mean(values: Floats) -> float:
        return float(values[-count:].mean())

    return HandedOn(
        again=(float(errors[0]), float(errors[1])),
        judged=(mean(learned.position_error), mean(learned.heading_error)),
        baseline=(mean(baseline.position_error), mean(baseline.heading_error)),
        motion=(mean(learned.distance), mean(learned.turn)),
        horizon=learned.horizon,
    )
