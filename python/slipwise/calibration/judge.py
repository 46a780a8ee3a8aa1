# SPDX-License-Identifier: Apache-2.0
"""The one judge of calibrations, evaluations and live learners: figures, and what contradicts them.

Beside them it says which limits of the drive a log does not show, and what pushes the robot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.handed_on import handed_on
from slipwise.calibration.judgement import Judgement, judgement_of
from slipwise.calibration.learned import Learned
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Verdict
from slipwise.calibration.settings import Settings
from slipwise.calibration.verdict import Identified, LogFacts, give_verdict, identified
from slipwise.models.body_force import ForcePart, force_parts, force_sentence
from slipwise.models.schema import UNIDENTIFIABLE_RATIO
from slipwise.number_text import number_text

_AXES = {
    _core.LimitedAxis.Speed: "speed",
    _core.LimitedAxis.YawRate: "yaw rate",
    _core.LimitedAxis.Side: "each side",
}
LEAST_DEAD_BAND = 1e-3  # m/s or rad/s; no drive's is less, so slower commands need not be tried


@dataclass(frozen=True, eq=False)
class ToJudge:
    """Predictions beside the kinematic baseline's, and facts about the model that made them."""

    predictions: Predictions
    baseline: Predictions  # of the same segments
    known: Identified
    limits: tuple[str, ...]  # advice on limits of the actuator
    horizons: tuple[Predictions, ...]  # the model's at all horizons
    again: NDArray[np.float64] | None = None  # errors of the model that is handed on, see `Learned`


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
    if learned.again is not None:
        judgement = replace(
            judgement, handed_on=handed_on(learned.predictions, learned.baseline, learned.again)
        )
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
    return ToJudge(
        learned.predictions[judged],
        learned.baseline[judged],
        known,
        limits,
        learned.predictions,
        learned.again,
    )


def advice_on_limits(search: _core.LimitSearch | None, *, kept: bool, wheels_logged: bool) -> tuple[str, ...]:
    """Return what there is to say of a search for limits: an empty tuple if there was none."""
    if search is None:
        return ()
    warnings = () if kept else doubted_limits(search, wheels_logged=wheels_logged)
    return (*warnings, *limits_advice(search))


def limits_advice(search: _core.LimitSearch) -> tuple[str, ...]:
    """Return one sentence for each kind of limit that no axis shows; beyond what was commanded none can.

    A dead-band that even the slowest commands do not show is none.
    """
    found = {limit.kind for limit in search.found}
    speed, turn = search.reach[0], search.reach[1]
    if speed.fastest == 0.0 and turn.fastest == 0.0:
        return ("No limit of the drive found: it was commanded to stand still.",)
    slowest = tuple(reach if reach > LEAST_DEAD_BAND else 0.0 for reach in (speed.slowest, turn.slowest))
    kinds, most = _core.LimitKind, _pair(speed.fastest, turn.fastest)
    steps = _pair(speed.step, turn.step)
    sentences = {
        kinds.dead_band: f"No dead band found; the smallest commands were {_pair(*slowest)}."
        if any(slowest)
        else "",
        kinds.saturation: f"No saturation found; the largest commands were {most}.",
        kinds.slew_rate_up: f"No acceleration limit found; the largest steps from rest were {steps}.",
        kinds.slew_rate_down: f"No braking limit found; the largest steps to rest were {steps}.",
    }
    return tuple(sentence for kind, sentence in sentences.items() if sentence and kind not in found)


def doubted_limits(search: _core.LimitSearch, *, wheels_logged: bool) -> tuple[str, ...]:
    """Return a sentence about limits that were found, yet not kept, as they predict no better."""
    if not search.found:
        return ()
    names = ", ".join(f"{_AXES[each.axis]}: {each.kind.name.replace('_', ' ')}" for each in search.found)
    remedy = "drive longer" if wheels_logged else "record wheel speeds"
    sentence = (
        f"The drive looks limited ({names}), but these limits do not improve predictions: the model leaves "
        f"them out, and its lags and delays may contain them. To decide, {remedy}."
    )
    return (sentence,)


def _pair(speed: float, turn: float) -> str:
    reached = ((speed, "m/s"), (turn, "rad/s"))
    return " and ".join(f"{number_text(value, 2)} {unit}" for value, unit in reached if value > 0.0)


def force_found(posterior: Posterior, settings: Settings) -> tuple[ForcePart, ...]:
    """Return what a posterior knows of each part of the force; an empty tuple if none was to be learned."""
    frame = settings.body_force.frame
    if frame == "none":
        return ()
    identifiable = np.asarray(posterior.variance_ratio <= UNIDENTIFIABLE_RATIO).tolist()
    names = [info.name for info in posterior.motion.parameters]
    return force_parts(frame, names, posterior.mean, posterior.covariance, identifiable)


def force_words(posterior: Posterior, settings: Settings) -> str:
    """Say what pushes the robot; empty where no force was to be learned."""
    parts = force_found(posterior, settings)
    return force_sentence(parts) if parts else ""
