# SPDX-License-Identifier: Apache-2.0
"""The held-out comparison of a method with the kinematic baseline and with a robot that stands still."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise.calibration.consistency import Consistency, consistency_of
from slipwise.calibration.handed_on import HandedOn
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import held_out_half, ratio_of_means
from slipwise.models.schema import HeldOut
from slipwise.number_text import number_text

FEWEST_WINDOWS = 4  # held-out segments; fewer cannot be judged
MUCH = 1.2  # ratio to the baseline beyond which an error is worse by a fault of the log, not by chance
LEAST_EXPLAINED = 0.5  # of the motion; a model that explains less follows inputs of something else
_SHOWS = 2.8  # times the mean error over the root of the segments, from which on a steady slip shows
_DRIVEN = (0.2, 0.2)  # m and rad in a segment; what is hardly driven shows no slip for that reason
_LARGER = 1.05  # ratio to the baseline from which on an error is said to be larger, though by chance perhaps
SAME = 1.01  # ratio to the baseline up to which an error counts as the same; both print alike then

Ratio = tuple[float, float, float]  # of two mean errors, with its 95 % interval
_UNKNOWN: Ratio = (np.nan, np.nan, np.nan)


@dataclass(frozen=True)
class Still:
    """The prediction "stands still", at the horizon where the model does best beside it."""

    horizon: float  # s
    error: float  # the model's mean error: m, or rad
    motion: float  # how far the robot moves: the mean error of one said to stand still
    turns: bool = False  # of headings, where positions tell nothing

    @property
    def explained(self) -> float:
        """The part of the motion that the inputs explain: 1 where predictions are right, 0 as for a rock."""
        return 1.0 - self.error / self.motion


@dataclass(frozen=True)
class Judgement:
    """The held-out comparison with the kinematic baseline."""

    held_out: HeldOut  # as `evaluate` shows them
    position_ratio: Ratio
    heading_ratio: Ratio
    still: Still | None  # None where nothing moved
    consistency: Consistency | None = None
    commanded: tuple[float, float] = (0.0, 0.0)  # m and rad in a segment, by the inputs
    handed_on: HandedOn | None = None  # the model as it is at the end, of one that learned on the way

    @property
    def hidden(self) -> dict[str, float]:
        """What a steady slip may be, as a part of the motion, without showing; of axes that were driven.

        A slip adds to errors that are there anyway, to either side; from two standard deviations of its mean
        over the segments on it shows, those of one being 1.4 of the mean error for each of the two sides.
        """
        error = (self.held_out.baseline_position, self.held_out.baseline_heading)
        if not self.held_out.segments:
            return {}
        shows = _SHOWS / math.sqrt(self.held_out.segments)
        return {
            axis: shows * wrong / motion
            for axis, wrong, motion, least in zip(
                ("speed", "turns"), error, self.commanded, _DRIVEN, strict=True
            )
            if motion > least
        }

    @property
    def too_short(self) -> bool:
        """Whether there are too few segments to judge."""
        return self.held_out.segments < FEWEST_WINDOWS

    @property
    def unexplained(self) -> bool:
        """Whether the inputs explain too little of the motion."""
        return self.still is not None and self.still.explained < LEAST_EXPLAINED

    @property
    def beats_baseline(self) -> bool:
        """Neither position nor heading worse, and one of them better, beyond chance."""
        return not self.fault()

    @property
    def worse(self) -> tuple[str, ...]:
        """Which of position and heading are worse than the baseline's, by more than chance explains."""
        return tuple(name for name, (value, low, _) in self._ratios().items() if value > MUCH or low > SAME)

    @property
    def perhaps_worse(self) -> dict[str, float]:
        """Ratios to the baseline of errors that are larger, though by chance perhaps; of what was driven."""
        return {
            name: ratio[0]
            for (name, ratio), motion, least in zip(
                self._ratios().items(), self.commanded, _DRIVEN, strict=True
            )
            if ratio[0] > _LARGER and motion > least and name not in self.worse
        }

    def fault(self) -> str:
        """Say why the method does not beat the kinematic baseline; empty where it does."""
        ratios = self._ratios()
        if self.worse:
            times = {name: number_text(ratios[name][0]) for name in self.worse}
            each = (f"its {name} error is {times[name]} times as large" for name in self.worse)
            return " and ".join(each)
        if any(ratio[2] < 1.0 for ratio in ratios.values()):
            return ""
        if all(ratio[0] == 1.0 for ratio in ratios.values()):
            return "its errors are the same"
        intervals = "; ".join(f"{name} {_interval(ratio)}" for name, ratio in ratios.items())
        return (
            f"its gain may be chance, since the 95 % intervals of its errors relative to the "
            f"baseline's hold 1 ({intervals})"
        )

    def _ratios(self) -> dict[str, Ratio]:
        return {"position": _or_one(self.position_ratio), "heading": _or_one(self.heading_ratio)}


def judgement_of(
    learned: Predictions, baseline: Predictions, horizons: Sequence[Predictions] = ()
) -> Judgement:
    """Compare a method with the kinematic baseline on the second half of the segments.

    `horizons` are the method's predictions at others too: where a robot drifts, inputs explain its motion for
    a second or two, and nothing after five.
    """
    half = held_out_half(len(learned))
    held_out = HeldOut(
        horizon=learned.horizon,
        segments=half.stop - half.start,
        position=_mean(learned.position_error[half]),
        heading=_mean(learned.heading_error[half]),
        baseline_position=_mean(baseline.position_error[half]),
        baseline_heading=_mean(baseline.heading_error[half]),
    )
    if held_out.segments == 0:
        return Judgement(held_out, _UNKNOWN, _UNKNOWN, None)
    turns = held_out.turns_alone or _stays(learned, baseline, horizons)
    still = [_still(each, turns=turns) for each in (*horizons, learned)]
    return Judgement(
        held_out,
        ratio_of_means(learned.position_error[half], baseline.position_error[half]),
        ratio_of_means(learned.heading_error[half], baseline.heading_error[half]),
        max((each for each in still if each is not None), key=lambda s: s.explained, default=None),
        consistency_of(learned),
        (_mean(np.hypot(*baseline.pose[half, :2].T)), _mean(np.abs(baseline.pose[half, 2]))),
    )


def _still(learned: Predictions, *, turns: bool) -> Still | None:
    half = held_out_half(len(learned))
    errors, motions = (
        (learned.heading_error, learned.turn) if turns else (learned.position_error, learned.distance)
    )
    motion = _mean(motions[half])
    if too_short(len(learned)) or motion <= 0.0:
        return None
    return Still(learned.horizon, _mean(errors[half]), motion, turns)


def _stays(learned: Predictions, baseline: Predictions, horizons: Sequence[Predictions]) -> bool:
    """Whether the robot is told to stay in its place, and does: its positions do no more than scatter.

    What is not driven goes with the root of the time at most; what drives or slides away, with the time.
    """
    shortest = min((each for each in horizons if len(each)), key=lambda each: each.horizon, default=learned)
    told = _mean(np.hypot(*baseline.pose[held_out_half(len(baseline)), :2].T))
    far, near = _way(learned), _way(shortest)
    return told < far < near * math.sqrt(learned.horizon / shortest.horizon)


def _way(learned: Predictions) -> float:
    return _mean(learned.distance[held_out_half(len(learned))])


def too_short(count: int) -> bool:
    """Say whether the held-out half of `count` predictions is too few segments to judge."""
    half = held_out_half(count)
    return bool(half.stop - half.start < FEWEST_WINDOWS)


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else 0.0


def _or_one(ratio: Ratio) -> Ratio:
    """A ratio that is not defined, since the baseline is never wrong, counts as a tie."""
    return (1.0, 1.0, 1.0) if np.isnan(ratio[0]) else ratio


def _interval(ratio: Ratio) -> str:
    value, low, high = (number_text(each) for each in ratio)
    return f"{value}, {low} to {high}"
