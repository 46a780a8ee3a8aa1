# SPDX-License-Identifier: Apache-2.0
"""Which of two methods of an evaluation predicts better, with intervals."""

from __future__ import annotations

from dataclasses import dataclass

from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.evaluation.result import Evaluation

Ratio = tuple[float, float, float]  # value, and its 95 % interval


@dataclass(frozen=True)
class HeadToHead:
    """The errors of one method relative to another's on the same held-out windows."""

    first: str
    second: str
    horizon: float  # s
    windows: int
    position: Ratio  # mean error of the second over that of the first
    heading: Ratio

    @property
    def better(self) -> str | None:
        """The one that is clearly better in position or heading and clearly worse in neither, or None."""
        ratios = (self.position, self.heading)
        second = any(high < 1.0 for _, _, high in ratios)
        first = any(low > 1.0 for _, low, _ in ratios)
        if first == second:
            return None
        return self.second if second else self.first


def head_to_head(evaluation: Evaluation, first: str, second: str) -> HeadToHead:
    """Compare two methods at the longest horizon, on the windows that are scored.

    Raises:
        KeyError: the evaluation does not have one of them.
    """
    longest = max(evaluation.horizons)
    found = {p.method: p for p in evaluation.predictions if p.horizon == longest}
    one, other = found[first], found[second]
    half = held_out_half(len(one))

    def ratio(error: str) -> Ratio:
        values = [getattr(p, error)[half] for p in (other, one)]
        return ratio_of_means(values[0], values[1])

    return HeadToHead(
        first, second, longest, half.stop - half.start, ratio("position_error"), ratio("heading_error")
    )
