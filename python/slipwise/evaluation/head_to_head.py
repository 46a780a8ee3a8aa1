# SPDX-License-Identifier: Apache-2.0
"""Which of two methods of an evaluation predicts better, with intervals."""

from __future__ import annotations

from dataclasses import dataclass

from slipwise.calibration.judgement import FEWEST_WINDOWS
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.evaluation.result import Evaluation

Ratio = tuple[float, float, float]  # value, and its 95 % interval


@dataclass(frozen=True)
class HeadToHead:
    """The errors of one method relative to another's on the same windows."""

    first: str
    second: str
    horizon: float  # s
    windows: int
    position: Ratio  # mean error of the second over that of the first
    heading: Ratio
    mean_position: tuple[float, float]  # m, of the first and of the second
    mean_heading: tuple[float, float]  # rad

    @property
    def too_few(self) -> bool:
        """Whether the windows are too few to tell."""
        return self.windows < FEWEST_WINDOWS

    @property
    def better(self) -> str | None:
        """The one that is clearly better in position or heading and clearly worse in neither, or None."""
        ratios = () if self.too_few else (self.position, self.heading)
        second = any(high < 1.0 for _, _, high in ratios)
        first = any(low > 1.0 for _, low, _ in ratios)
        if first == second:
            return None
        return self.second if second else self.first


def head_to_head(
    evaluation: Evaluation, first: str, second: str, *, horizon: float | None = None, every: bool = False
) -> HeadToHead:
    """Compare two methods at a horizon, by default the longest, on the windows that are scored.

    `every` takes all windows: of methods that learned nothing from the log, the first half counts as well.

    Raises:
        KeyError: the evaluation does not have one of them.
    """
    seconds = max(evaluation.horizons) if horizon is None else horizon
    found = {p.method: p for p in evaluation.predictions if p.horizon == seconds}
    one, other = found[first], found[second]
    half = slice(0, len(one)) if every else held_out_half(len(one))

    def means(error: str) -> tuple[Ratio, tuple[float, float]]:
        mine, theirs = (getattr(p, error)[half] for p in (one, other))
        return ratio_of_means(theirs, mine), (float(mine.mean()), float(theirs.mean()))

    (position, positions), (heading, headings) = means("position_error"), means("heading_error")
    return HeadToHead(first, second, seconds, half.stop - half.start, position, heading, positions, headings)
