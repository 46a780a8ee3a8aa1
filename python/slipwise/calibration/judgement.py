# SPDX-License-Identifier: Apache-2.0
"""The held-out comparison of a method with the kinematic baseline: is it better, and if not, why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.calibration.consistency import Consistency, consistency_of
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.models.schema import HeldOut
from slipwise.number_text import number_text

FEWEST_WINDOWS = 4  # held-out segments; fewer cannot be judged
MUCH = 1.2  # ratio to the baseline beyond which an error is worse by a fault of the log, not by chance
BY_START = 0.9  # of the product of both ratios; what the start of predictions gains beyond that is named
SAME = 1.01  # ratio to the baseline up to which an error counts as the same; both print alike then

Ratio = tuple[float, float, float]  # of two mean errors, with its 95 % interval


@dataclass(frozen=True)
class Judgement:
    """The held-out comparison with the kinematic baseline."""

    held_out: HeldOut  # as `evaluate` shows them
    position_ratio: Ratio  # from the same measured start, which is not the model's merit
    heading_ratio: Ratio
    consistency: Consistency | None = None

    @property
    def too_short(self) -> bool:
        """Whether there are too few segments to judge."""
        return self.held_out.windows < FEWEST_WINDOWS

    @property
    def beats_baseline(self) -> bool:
        """Neither position nor heading worse on the segments seen, and one of them better beyond chance."""
        return not self.fault()

    @property
    def worse(self) -> tuple[str, ...]:
        """Which of position and heading are worse than the baseline's on the segments seen."""
        shown = self._shown_ratios()
        return tuple(name for name in shown if self._worst(name) > SAME)

    @property
    def much_worse(self) -> bool:
        """Whether an error is so much worse that chance is no explanation."""
        return any(self._worst(name) > MUCH or self._ratios()[name][1] > SAME for name in self.worse)

    @property
    def gains_by_start(self) -> bool:
        """Whether the errors shown are smaller than the model's own by where its predictions start."""
        shown, own = self._shown_ratios(), self._ratios()
        return shown["position"] * shown["heading"] < BY_START * own["position"][0] * own["heading"][0]

    def fault(self) -> str:
        """Say why the method does not beat the kinematic baseline; empty where it does."""
        ratios, start = self._ratios(), " from the same measured pose" if self.gains_by_start else ""
        if self.worse:
            times = {name: number_text(self._worst(name)) for name in self.worse}
            each = (f"its {name} error is {times[name]} times as large" for name in self.worse)
            return f"{' and '.join(each)}{start}"
        if any(ratio[2] < 1.0 for ratio in ratios.values()):
            return ""
        if all(ratio[0] == 1.0 for ratio in ratios.values()):
            return f"its errors are the same{start}"
        intervals = "; ".join(f"{name} {_interval(ratio)}" for name, ratio in ratios.items())
        return (
            f"its gain{start} may be chance, since the 95 % intervals of its errors relative to the "
            f"baseline's hold 1 ({intervals})"
        )

    def _worst(self, name: str) -> float:
        """The error over the baseline's, from the measured pose or as shown."""
        return max(self._ratios()[name][0], self._shown_ratios()[name])

    def _ratios(self) -> dict[str, Ratio]:
        return {"position": _or_one(self.position_ratio), "heading": _or_one(self.heading_ratio)}

    def _shown_ratios(self) -> dict[str, float]:
        """The errors shown, over the baseline's; 1 where that is never wrong."""
        h = self.held_out
        pairs = {"position": (h.position, h.plain_position), "heading": (h.heading, h.plain_heading)}
        return {name: own / plain if plain > 0.0 else 1.0 for name, (own, plain) in pairs.items()}


def judge(learned: Predictions, baseline: Predictions) -> Judgement:
    """Compare a method with the kinematic baseline on the second half of the segments.

    Errors are those of the predictions as they were made. Ratios are between predictions that start at the
    measured pose, both: where the last poses are averaged, that helps whatever was learned.
    """
    half, alike = held_out_half(len(learned)), learned.at_measured_start
    held_out = HeldOut(
        horizon=learned.horizon,
        windows=half.stop - half.start,
        position=_mean(learned.position_error[half]),
        heading=_mean(learned.heading_error[half]),
        plain_position=_mean(baseline.position_error[half]),
        plain_heading=_mean(baseline.heading_error[half]),
    )
    if held_out.windows == 0:
        return Judgement(held_out, (np.nan, np.nan, np.nan), (np.nan, np.nan, np.nan))
    return Judgement(
        held_out,
        ratio_of_means(alike.position_error[half], baseline.position_error[half]),
        ratio_of_means(alike.heading_error[half], baseline.heading_error[half]),
        consistency_of(learned),
    )


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else 0.0


def _or_one(ratio: Ratio) -> Ratio:
    """A ratio that is not defined, since the baseline is never wrong, counts as a tie."""
    return (1.0, 1.0, 1.0) if np.isnan(ratio[0]) else ratio


def _interval(ratio: Ratio) -> str:
    value, low, high = (number_text(each) for each in ratio)
    return f"{value}, {low} to {high}"
