# SPDX-License-Identifier: Apache-2.0
"""The verdict: does the model beat doing nothing, what is not determined, and which drive would help."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.calibration.identifiability import (
    advice_for_pairs,
    drives_for,
    look_alikes,
    timing_words,
    undetermined,
)
from slipwise.calibration.learner import Belief
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Verdict
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.models.schema import HeldOut

FEWEST_WINDOWS = 4  # held-out windows; fewer cannot be judged
WORSE = 1.02  # ratio to the plain model beyond which an error counts as worse


@dataclass(frozen=True)
class Judgement:
    """The held-out comparison with the plain model."""

    held_out: HeldOut  # as `evaluate` shows them
    position_ratio: tuple[float, float, float]  # from the same measured start, which is not the model's merit
    heading_ratio: tuple[float, float, float]

    @property
    def beats_plain(self) -> bool:
        """Better on the whole, one of position and heading beyond chance, and neither clearly worse."""
        position, heading = _or_one(self.position_ratio), _or_one(self.heading_ratio)
        clearly_worse = position[1] > WORSE or heading[1] > WORSE
        clearly_better = position[2] < 1.0 or heading[2] < 1.0
        return position[0] * heading[0] < 1.0 and clearly_better and not clearly_worse

    @property
    def gains_by_start(self) -> bool:
        """Whether the errors shown are smaller than the plain model's by where they start alone."""
        h = self.held_out
        better = h.position * h.heading < h.plain_position * h.plain_heading
        return better and not self.beats_plain and self.position_ratio[0] * self.heading_ratio[0] >= 1.0


def judge(learned: Predictions, plain: Predictions) -> Judgement:
    """Compare a method with the plain model on the second half of the windows.

    Errors are those of the predictions as they were made. Ratios are between predictions that start at the
    measured pose, both: where the last poses are averaged, that helps whatever was learned.
    """
    half, alike = held_out_half(len(learned)), learned.at_measured_start
    held_out = HeldOut(
        horizon=learned.horizon,
        windows=half.stop - half.start,
        position=_mean(learned.position_error[half]),
        heading=_mean(learned.heading_error[half]),
        plain_position=_mean(plain.position_error[half]),
        plain_heading=_mean(plain.heading_error[half]),
    )
    if held_out.windows == 0:
        return Judgement(held_out, (np.nan, np.nan, np.nan), (np.nan, np.nan, np.nan))
    return Judgement(
        held_out,
        ratio_of_means(alike.position_error[half], plain.position_error[half]),
        ratio_of_means(alike.heading_error[half], plain.heading_error[half]),
    )


def give_verdict(
    judgement: Judgement, belief: Belief, *, wheels_logged: bool, wheels_advice: str = ""
) -> Verdict:
    """Put the judgement, what is not determined and what looks alike into words."""
    unknown, pairs = undetermined(belief), look_alikes(belief)
    good, sentence = _sentence(judgement, len(unknown), len(belief.mean))
    longer = ("Record a longer drive.",) if _too_short(judgement) else ()
    return Verdict(
        good,
        sentence,
        unknown,
        (*longer, *drives_for(unknown), *advice_for_pairs(pairs)),
        pairs,
        timing_words(belief.motion, unknown, wheels_logged=wheels_logged, wheels_advice=wheels_advice),
    )


def _too_short(judgement: Judgement) -> bool:
    return judgement.held_out.windows < FEWEST_WINDOWS


def _sentence(judgement: Judgement, unknown: int, parameters: int) -> tuple[bool, str]:
    held_out = judgement.held_out
    if _too_short(judgement):
        return False, (
            f"Too little driving to judge: {held_out.windows} held-out windows of {held_out.horizon:g} s, "
            f"at least {FEWEST_WINDOWS} are needed."
        )
    figures = (
        f"{held_out.position:.3g} m and {held_out.heading:.3g} rad after {held_out.horizon:g} s, "
        f"where the plain model misses by {held_out.plain_position:.3g} m "
        f"and {held_out.plain_heading:.3g} rad "
        f"({held_out.windows} held-out windows)"
    )
    if not judgement.beats_plain:
        start = (
            " It gains by averaging the last poses, not by what it learned."
            if judgement.gains_by_start
            else ""
        )
        return (
            False,
            f"Do not use this model: it does not beat the plain model. It misses by {figures}.{start}",
        )
    tail = (
        f" {unknown} of {parameters} parameters stay about where they were before the log." if unknown else ""
    )
    return True, f"The learned model misses by {figures}.{tail}"


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else 0.0


def _or_one(ratio: tuple[float, float, float]) -> tuple[float, float, float]:
    """A ratio that is not defined, since the plain model is never wrong, counts as a tie."""
    return (1.0, 1.0, 1.0) if np.isnan(ratio[0]) else ratio
