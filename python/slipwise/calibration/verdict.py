# SPDX-License-Identifier: Apache-2.0
"""The verdict in words, of calibrations and evaluations: may the model be used, why not, and what to do."""

from __future__ import annotations

from dataclasses import dataclass, replace

from slipwise.calibration.identifiability import (
    Confounded,
    advice_for_pairs,
    confounded,
    drives_for,
    longest_delay,
    not_identifiable,
    timing_words,
    uphill,
)
from slipwise.calibration.judgement import FEWEST_WINDOWS, LEAST_EXPLAINED, Judgement
from slipwise.calibration.learner import Posterior
from slipwise.calibration.result import Verdict
from slipwise.logs.findings.finding import Finding
from slipwise.models.parameter_table import physical_name
from slipwise.models.schema import HeldOut
from slipwise.number_text import count_text, number_text

_MOST_NAMED = 5  # parameters that a sentence names
_REFUSED = "Do not use this model:"
_FOLLOWED = {"command": "commands", "wheel": "wheels"}
POSITIONS_ONLY = (
    "Only positions were measured: headings are those of the path fitted to them, which over 1 s says little "
    "of turns, and a constant side slip cannot be seen."
)
YAW_RATES_ONLY = (
    "Only yaw rates were measured: slip is learned of turns alone, and predicted positions follow the inputs "
    "along the learned heading."
)
_CLOCKS = (
    "Give --pose-clock-offset auto, or the seconds to add to the stamps of the poses. The headers of the "
    "original bag show how far the clocks are apart."
)
_ATTITUDE = (
    "Change the sign of what is named: nose down is a positive pitch, left side up a positive roll "
    "(REP-103), and a force that pushes ahead or to the left is positive."
)
LATEST = 1.0  # s from a command to its first effect; no drive takes longer
HIDDEN = 0.05  # of the motion; where errors hide a larger slip, no robot is said to have none
FEW = 20  # held-out segments; a gain that shows in fewer may be chance


@dataclass(frozen=True)
class Identified:
    """Facts about a model's parameters."""

    parameters: int
    not_identifiable: tuple[str, ...]
    advice: tuple[str, ...] = ()
    confounded: tuple[Confounded, ...] = ()
    timing: str = ""
    from_log: str = "this log"  # that the parameters were learned from
    force: str = ""  # what pushes the robot beside its slip
    delay: float = 0.0  # s, the longest from an input to its first effect
    uphill: tuple[str, ...] = ()  # "ahead", "to the side": where gravity seems to push it


@dataclass(frozen=True)
class LogFacts:
    """What the measurements themselves say about a verdict; whoever judges has to know all of it."""

    contradictions: tuple[Finding, ...]
    shortage: tuple[str, ...]  # why there are so few segments, and what to do, where they are too few
    input_name: str
    positions: bool  # only positions were measured
    clocks_compared: bool  # header stamps were compared with the times of receipt


def identified(
    posterior: Posterior,
    *,
    wheels_logged: bool,
    wheels_advice: str = "",
    positions: bool = False,
    gyro_alone: bool = False,
) -> Identified:
    """Say what a posterior knows of its parameters, and which driving would tell the rest."""
    unknown, pairs = not_identifiable(posterior), confounded(posterior)
    teachable = tuple(name for name in unknown if not (gyro_alone and name.startswith(("lon.", "lat."))))
    advice = (*drives_for(teachable, positions=positions), *advice_for_pairs(pairs))
    timing = timing_words(posterior.motion, unknown, wheels_logged=wheels_logged, wheels_advice=wheels_advice)
    names = tuple(info.name for info in posterior.motion.parameters)
    delay = longest_delay(names, posterior.mean.tolist())
    return Identified(
        len(posterior.mean), unknown, advice, pairs, timing, delay=delay, uphill=uphill(posterior)
    )


def give_verdict(judgement: Judgement, known: Identified, facts: LogFacts) -> Verdict:
    """Put a judgement into words: the fault that weighs most, the figures, and what to do."""
    contradicted = tuple(each for each in facts.contradictions if each.spoils)
    stopped = _stopped(judgement, facts)
    fault = (
        _contradicted(contradicted)
        or _not_judged(judgement)
        or _unexplained(judgement, facts)
        or _not_better(judgement)
        or _untrue(judgement)
        or stopped
        or _too_late(known, facts)
        or _uphill(known)
    )
    if stopped:  # which says all of it
        judgement = replace(judgement, handed_on=None)
    reservations = _reservations(judgement, facts)
    if known.delay > LATEST and facts.clocks_compared:
        reservations = (*reservations, f"It answers after {known.delay:.2g} s, which no drive needs.")
    sentences = [fault]
    if not contradicted and not judgement.too_short:
        figures = (
            _turns(judgement.held_out) if judgement.held_out.turns_alone else _figures(judgement.held_out)
        )
        sentences += [figures, *reservations, "" if fault else _unknown(known)]
    of_nothing = contradicted or (judgement.unexplained and not judgement.too_short)
    advice = (*_advice(judgement, facts), *(() if of_nothing else known.advice))
    if not contradicted and _too_late(known, facts):
        advice = (_CLOCKS, *advice)
    if not contradicted and known.uphill:
        advice = (_ATTITUDE, *advice)
    return Verdict(
        not fault,
        " ".join(sentence for sentence in sentences if sentence),
        known.not_identifiable,
        tuple(dict.fromkeys(advice)),
        known.confounded,
        "" if contradicted else known.timing,
        () if fault else reservations,
        force="" if contradicted else known.force,
        contradictions=tuple(each.sentence for each in contradicted),
    )


def _contradicted(contradictions: tuple[Finding, ...]) -> str:
    return f"{_REFUSED} {'; '.join(each.sentence for each in contradictions)}." if contradictions else ""


def _not_judged(judgement: Judgement) -> str:
    if not judgement.too_short:
        return ""
    return (
        f"Too little driving to judge: {count_text(judgement.held_out.segments, 'held-out segment')} of "
        f"{judgement.held_out.horizon:g} s, at least {FEWEST_WINDOWS} are needed."
    )


def _unexplained(judgement: Judgement, facts: LogFacts) -> str:
    """That the inputs say little of how the robot moves: they may be those of another one."""
    if not judgement.unexplained:
        return ""
    still, inputs = judgement.still, _FOLLOWED[facts.input_name]
    assert still is not None
    unit = "rad" if still.turns else "m"
    share, least = 100.0 * max(still.explained, 0.0), 100.0 * LEAST_EXPLAINED
    return (
        f"{_REFUSED} the {inputs} do not explain the poses. They explain {share:.0f} % of the motion, a "
        f"good model at least {least:.0f} %: standing still misses by "
        f"{number_text(still.motion)} {unit} after {still.horizon:g} s, the model by "
        f"{number_text(still.error)} {unit}."
    )


def _not_better(judgement: Judgement) -> str:
    fault = judgement.fault()
    return f"{_REFUSED} it does not beat the kinematic baseline: {fault}." if fault else ""


def _untrue(judgement: Judgement) -> str:
    if judgement.consistency is None or not judgement.consistency.untrue:
        return ""
    return f"{_REFUSED} its uncertainty is not that of its errors."


def _stopped(judgement: Judgement, facts: LogFacts) -> str:
    kept = judgement.handed_on
    fault = kept.fault({each.kind for each in facts.contradictions}) if kept is not None else ""
    return f"{_REFUSED} {fault}." if fault else ""


def _too_late(known: Identified, facts: LogFacts) -> str:
    if known.delay <= LATEST or facts.clocks_compared:
        return ""
    return (
        f"{_REFUSED} the poses answer the {_FOLLOWED[facts.input_name]} after {known.delay:.2g} s, later "
        "than any drive: their clocks differ."
    )


def _uphill(known: Identified) -> str:
    ways = " and ".join(known.uphill)
    return f"{_REFUSED} by it the robot creeps uphill or against the known force, {ways}." if ways else ""


def _reservations(judgement: Judgement, facts: LogFacts) -> tuple[str, ...]:
    """What is to be known of a model beside its figures, even where it is good; sentences."""
    partly = [
        f"{each.sentence[0].upper()}{each.sentence[1:]}." for each in facts.contradictions if each.reserves
    ]
    larger = [
        f"Its {name} error is {number_text(ratio)} times the baseline's, which may be chance."
        for name, ratio in judgement.perhaps_worse.items()
    ]
    honest = "" if judgement.consistency is None else judgement.consistency.sentence()
    courses = POSITIONS_ONLY if facts.positions else ""
    turns = YAW_RATES_ONLY if judgement.held_out.turns_alone else ""
    unlike = "" if judgement.handed_on is None else judgement.handed_on.sentence()
    return tuple(sentence for sentence in (*larger, honest, unlike, *partly, courses, turns) if sentence)


def _figures(held_out: HeldOut) -> str:
    return (
        f"The model misses by {held_out.position:.3g} m and {held_out.heading:.3g} rad after "
        f"{held_out.horizon:g} s, the kinematic baseline by {held_out.baseline_position:.3g} m and "
        f"{held_out.baseline_heading:.3g} rad ({held_out.segments} held-out segments)."
    )


def _turns(held_out: HeldOut) -> str:
    """The figures of a log without poses."""
    return (
        f"The model's heading misses by {held_out.heading:.3g} rad after {held_out.horizon:g} s, the "
        f"kinematic baseline's by {held_out.baseline_heading:.3g} rad "
        f"({held_out.segments} held-out segments)."
    )


def _unknown(known: Identified) -> str:
    count = len(known.not_identifiable)
    if count == 0 or known.parameters == 0:
        return ""
    named = ", ".join(physical_name(name) for name in known.not_identifiable[:_MOST_NAMED])
    more = f" and {count - _MOST_NAMED} more" if count > _MOST_NAMED else ""
    which = f"{count} of {known.parameters} parameters could not be learned from {known.from_log}"
    return f"{which}: {named}{more}."


def _advice(judgement: Judgement, facts: LogFacts) -> tuple[str, ...]:
    """What to do about the faults and the reservations."""
    advice = [text for each in facts.contradictions if each.judged for text in each.advice]
    if any(each.spoils for each in facts.contradictions):
        return tuple(advice)
    if judgement.too_short:
        return (*facts.shortage, *advice)
    if judgement.unexplained:
        advice.append(
            f"Check that {_FOLLOWED[facts.input_name]} and poses come from the same robot, drive and clock, "
            "in m/s, rad/s, m and rad."
        )
    elif judgement.worse:
        advice.append(
            "Look at the report for late poses, pose jumps or a wrong topic; until then use the kinematic "
            "baseline."
        )
    elif not judgement.beats_baseline:
        advice.append(_more_or_none(judgement, facts.input_name))
    if judgement.consistency is not None:
        advice += judgement.consistency.advice()
    if judgement.handed_on is not None:
        advice += judgement.handed_on.advice()
    return tuple(advice)


def _more_or_none(judgement: Judgement, input_name: str) -> str:
    """What to do where the gain may be chance."""
    held_out, followed = judgement.held_out, _FOLLOWED[input_name]
    if held_out.segments < FEW:
        minutes = 2.0 * FEW * held_out.horizon / 60.0
        return (
            f"Record a longer drive: {held_out.segments} held-out segments of {held_out.horizon:g} s tell "
            f"little; {FEW} take {minutes:.2g} minutes of driving."
        )
    hidden = {axis: part for axis, part in judgement.hidden.items() if part > HIDDEN}
    if hidden:
        slip = " or ".join(f"{100.0 * part:.0f} % of the {axis}" for axis, part in hidden.items())
        return (
            f"The errors, by noise of the poses or slip that comes and goes, hide a steady slip of {slip}, "
            f"if not more: whether this robot follows its {followed} as they are is not known. Record poses "
            "with less noise (RTK, a localiser), or a drive several times as long that goes straight and "
            "turns for seconds."
        )
    return (
        f"This robot follows its {followed} as they are: use the kinematic baseline, or record "
        "driving that is faster or turns more."
    )
