# SPDX-License-Identifier: Apache-2.0
"""The one judge of calibrations, evaluations and live learners: figures, and what contradicts them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from slipwise.calibration.force_words import force_words
from slipwise.calibration.judgement import Judgement, judgement_of
from slipwise.calibration.learned import Learned
from slipwise.calibration.limit_words import advice_on_limits
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Verdict
from slipwise.calibration.settings import Settings
from slipwise.calibration.verdict import Identified, LogFacts, give_verdict, identified


@dataclass(frozen=True, eq=False)
class ToJudge:
    """Predictions beside the kinematic baseline's, and facts about the model that made them."""

    predictions: Predictions
    baseline: Predictions  # of the same segments
    known: Identified
    limits: tuple[str, ...]  # advice on limits of the actuator
    horizons: tuple[Predictions, ...]  # the model's at all horizons


@dataclass(frozen=True, eq=False)
class Judged:
    """The figures, and the verdict on them."""

    judgement: Judgement
    verdict: Verdict


@dataclass(frozen=True)
class Sensors:
    """Measurements that the learner does not use."""

    wheels: bool  # wheel speeds, beside the commands
    wheels_advice: str  # what would give them, where the log could have them
    gyro_alone: bool  # no poses, but yaw rates


def judge(learned: ToJudge, facts: LogFacts) -> Judged:
    """Judge what was learned, knowing what the measurements say of themselves."""
    judgement = judgement_of(learned.predictions, learned.baseline, learned.horizons)
    verdict = give_verdict(judgement, learned.known, facts)
    if not verdict.contradictions:
        verdict = replace(verdict, advice=tuple(dict.fromkeys((*verdict.advice, *learned.limits))))
    return Judged(judgement, verdict)


def to_judge(learned: Learned, settings: Settings, sensors: Sensors, *, positions: bool) -> ToJudge:
    """Return what is judged of what was learned.

    Args:
        learned: the predictions are those that `evaluate` makes of the same method, so that one error stands
            in the verdict, the model file, the report and the scores.
        settings: that it was learned with.
        sensors: what was measured.
        positions: only positions were measured.
    """
    known = identified(
        learned.identifiable,
        wheels_logged=sensors.wheels,
        wheels_advice=sensors.wheels_advice,
        positions=positions,
        gyro_alone=sensors.gyro_alone,
    )
    known = replace(known, force=force_words(learned.identifiable, settings))
    kept = learned.kept.limits is not None
    limits = advice_on_limits(learned.limits, kept=kept, wheels_logged=sensors.wheels)
    judged = learned.judged
    return ToJudge(learned.predictions[judged], learned.baseline[judged], known, limits, learned.predictions)
