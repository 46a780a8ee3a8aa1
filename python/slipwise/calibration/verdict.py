# SPDX-License-Identifier: Apache-2.0
"""The verdict: does the model beat doing nothing, what is not determined, and which drive would help."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.calibration.learner import Belief
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Verdict
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.models.schema import HeldOut

FEWEST_WINDOWS = 4  # held-out windows; fewer cannot be judged
WORSE = 1.02  # ratio to the plain model beyond which an error counts as worse
UNDETERMINED_RATIO = 0.5  # posterior / prior variance above which a parameter counts as not determined


@dataclass(frozen=True)
class Judgement:
    """The held-out comparison with the plain model."""

    held_out: HeldOut
    position_ratio: tuple[float, float, float]
    heading_ratio: tuple[float, float, float]

    @property
    def beats_plain(self) -> bool:
        """Better on the whole, one of position and heading beyond chance, and neither clearly worse."""
        position, heading = _or_one(self.position_ratio), _or_one(self.heading_ratio)
        clearly_worse = position[1] > WORSE or heading[1] > WORSE
        clearly_better = position[2] < 1.0 or heading[2] < 1.0
        return position[0] * heading[0] < 1.0 and clearly_better and not clearly_worse


def judge(learned: Predictions, plain: Predictions) -> Judgement:
    """Compare a method with the plain model on the second half of the windows."""
    half = held_out_half(len(learned))
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
        ratio_of_means(learned.position_error[half], plain.position_error[half]),
        ratio_of_means(learned.heading_error[half], plain.heading_error[half]),
    )


def give_verdict(judgement: Judgement, names: tuple[str, ...], belief: Belief) -> Verdict:
    """Put the judgement and what is not determined into words."""
    undetermined = tuple(
        name for name, ratio in zip(names, belief.variance_ratio, strict=True) if ratio > UNDETERMINED_RATIO
    )
    advice = drives_for(undetermined)
    held_out = judgement.held_out
    if held_out.windows < FEWEST_WINDOWS:
        sentence = (
            f"Too little driving to judge: {held_out.windows} held-out windows of {held_out.horizon:g} s, "
            f"at least {FEWEST_WINDOWS} are needed."
        )
        return Verdict(False, sentence, undetermined, ("Record a longer drive.", *advice))
    figures = (
        f"{held_out.position:.3g} m and {held_out.heading:.3g} rad after {held_out.horizon:g} s, "
        f"where the plain model misses by {held_out.plain_position:.3g} m "
        f"and {held_out.plain_heading:.3g} rad "
        f"({held_out.windows} held-out windows)"
    )
    if not judgement.beats_plain:
        return Verdict(
            False,
            f"Do not use this model: it does not beat the plain model. It misses by {figures}.",
            undetermined,
            advice,
        )
    tail = (
        f" {len(undetermined)} of {len(names)} parameters are not determined by this log."
        if undetermined
        else ""
    )
    return Verdict(True, f"The learned model misses by {figures}.{tail}", undetermined, advice)


def drives_for(undetermined: tuple[str, ...]) -> tuple[str, ...]:
    """Say which driving would determine the parameters, in words."""
    advice = []
    for matches, sentence in _DRIVES:
        names = [name for name in undetermined if matches(name)]
        if names:
            advice.append(f"{sentence} (for {', '.join(names)}).")
    return tuple(advice)


def _terms(name: str) -> str:
    return name.partition(".")[2]


def _turns(name: str) -> bool:
    return "w" in _terms(name) or "kappa" in _terms(name)


_DRIVES = (
    (
        lambda n: "lag" in n or "delay" in n,
        "Change speed and yaw rate in steps, from rest and back, several times",
    ),
    (
        lambda n: n == "clock_offset",
        "Accelerate, brake and swing in and out of turns; steady driving cannot show a clock offset",
    ),
    (
        lambda n: "gx" in _terms(n) or "gy" in _terms(n),
        "Drive up, down and across a slope, with roll and pitch in the log",
    ),
    (lambda n: _turns(n) and "V" in _terms(n), "Drive arcs of both hands at several speeds"),
    (lambda n: _turns(n) and "V" not in _terms(n), "Turn both ways at several yaw rates, in place too"),
    (
        lambda n: "V" in _terms(n) and not _turns(n) and "g" not in _terms(n),
        "Drive straight at several speeds, forwards and backwards",
    ),
)


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else 0.0


def _or_one(ratio: tuple[float, float, float]) -> tuple[float, float, float]:
    """A ratio that is not defined, since the plain model is never wrong, counts as a tie."""
    return (1.0, 1.0, 1.0) if np.isnan(ratio[0]) else ratio
