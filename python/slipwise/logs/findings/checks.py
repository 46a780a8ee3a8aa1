# SPDX-License-Identifier: Apache-2.0
"""The list of all checks, and what they find in a log or in what a learner was given so far."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from slipwise import _core
from slipwise.logs.findings.askew_attitude import AskewAttitude
from slipwise.logs.findings.clock_drift import ClockDrift
from slipwise.logs.findings.clocks import CLOCKS
from slipwise.logs.findings.command_answers import DeadBand, EchoedCommands, Overridden
from slipwise.logs.findings.command_stops import CommandTimeout
from slipwise.logs.findings.course_heading import CourseHeading
from slipwise.logs.findings.drifting_poses import DriftingPoses
from slipwise.logs.findings.encoders import ReversalJumps, WheelSpikes
from slipwise.logs.findings.filled_poses import FilledPoses
from slipwise.logs.findings.filtered_poses import FilteredPoses
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.gyro_scale import GyroLate, GyroScale, GyroTurnsOtherwise
from slipwise.logs.findings.headings import (
    BackwardPoses,
    ConstantHeading,
    HeadingJump,
    LostHeading,
    OtherUnit,
    TurnedPoses,
    UnlikelySpeed,
)
from slipwise.logs.findings.late_answers import EarlyAnswers, LateAnswers
from slipwise.logs.findings.lost_sign import LostSign
from slipwise.logs.findings.missing_turns import MissingTurns
from slipwise.logs.findings.out_of_order import OutOfOrder
from slipwise.logs.findings.plausibility import ENOUGH, ENOUGH_TURN, Implausible, UnreachablePoses
from slipwise.logs.findings.pose_streams import ClockOffset, FrozenPoses
from slipwise.logs.findings.readings import READINGS
from slipwise.logs.findings.repeated_wheels import RepeatedWheels
from slipwise.logs.findings.saturation import Saturated
from slipwise.logs.findings.seen import AT_CENTRE, Place, Seen, WholeLog
from slipwise.logs.findings.sensor_place import SensorOffCentre
from slipwise.logs.findings.sideways_speed import SidewaysSpeed
from slipwise.logs.findings.source_scale import SourceScale
from slipwise.logs.findings.source_turns import SourceTurns
from slipwise.logs.findings.sources import IdleSource, TwoSources
from slipwise.logs.findings.standstill import DoesNotMove
from slipwise.logs.findings.steering import Commanded, NotSteered
from slipwise.logs.findings.topics import TOPICS, ArmJoints
from slipwise.logs.findings.towed_poses import TowedPoses
from slipwise.logs.findings.uneven_wheels import UnevenWheels
from slipwise.logs.findings.wheel_layout import LAYOUTS
from slipwise.logs.findings.wheel_twists import DeadWheel, ParentTwist, Unrelated, WheelSize
from slipwise.logs.gyro import gyro_rows
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Log, Run, has_course
from slipwise.logs.motion_windows import evidence_of

_LONG = 4  # times as many windows suffice of a robot that hardly turns, or only turns

#: What else looks wrong follows from these.
FIRST: tuple[Check, ...] = (
    NotSteered(),
    DeadWheel(),
    LostSign(),
    SidewaysSpeed(),
    Implausible(),
    UnreachablePoses(),
)
#: In the order in which they are looked for: what explains others comes before them.
THEN: tuple[Check, ...] = (
    UnlikelySpeed(),
    DoesNotMove(),
    GyroTurnsOtherwise(),
    ParentTwist(),
    CourseHeading(),
    TurnedPoses(),
    BackwardPoses(),
    ConstantHeading(),
    HeadingJump(),
    SensorOffCentre(),
    LostHeading(),
    RepeatedWheels(),
    UnevenWheels(),
    WheelSize(),
    OtherUnit(),
    MissingTurns(),
    Unrelated(),
)
#: What is looked for in poses of further sources too.
OF_SOURCE: tuple[Check, ...] = (FilteredPoses(),)
_BESIDE_FIRST = SourceTurns()  # of one in which nothing else is wrong
_OF_PLACE = {check.kind for check in (TurnedPoses, BackwardPoses, SensorOffCentre)}
#: What only a whole log shows.
WHOLE: tuple[Check, ...] = (
    GyroTurnsOtherwise(),
    OutOfOrder(),
    CommandTimeout(),
    ArmJoints(),
    WheelSpikes(),
    ReversalJumps(),
    EchoedCommands(),
    DeadBand(),
    Saturated(),
    LateAnswers(),
    EarlyAnswers(),
    Overridden(),
    FrozenPoses(),
    TowedPoses(),
    FilledPoses(),
    FilteredPoses(),
    DriftingPoses(),
    AskewAttitude(),
    ClockOffset(),
    ClockDrift(),
    SourceScale(),
    GyroScale(),
    GyroLate(),
    TwoSources(),
    *LAYOUTS,
)
#: What a live node looks for in its last minutes; two sources of wheels or poses it watches as they come.
OF_STREAM: tuple[Check, ...] = (
    OutOfOrder(),
    WheelSpikes(),
    ReversalJumps(),
    EchoedCommands(),
    Saturated(),
    LateAnswers(),
    EarlyAnswers(),
    Overridden(),
    FrozenPoses(),
    TowedPoses(),
    FilledPoses(),
    FilteredPoses(),
    DriftingPoses(),
    AskewAttitude(),
    ClockOffset(),
    ClockDrift(),
    SourceScale(),
    GyroScale(),
    GyroLate(),
    IdleSource(),
)
#: Each once, also what readers and live nodes find.
EVERY: tuple[Check, ...] = tuple(
    {c.kind: c for c in (*FIRST, *THEN, *WHOLE, _BESIDE_FIRST, *CLOCKS, *TOPICS, *READINGS)}.values()
)


def findings_in(seen: Seen) -> tuple[Finding, ...]:
    """Return what was found to be wrong, in all that was driven or lately.

    An hour of good driving hides a localiser that freezes or a sign that flips: the last two minutes of
    driving are judged by the same rules.
    """
    found = _found_in_part(seen)
    recent = seen.evidence.recent if isinstance(seen.evidence, _core.MotionEvidence) else None
    if recent is None or any(each.spoils for each in found):
        return found
    lately = _found_in_part(replace(seen, evidence=recent))
    spoilt = tuple(_lately(each) for each in lately if each.spoils)
    kinds = {each.kind for each in spoilt}
    return (*spoilt, *(each for each in found if each.kind not in kinds))


def _lately(found: Finding) -> Finding:
    """Say that it is so of the last minutes alone."""
    advice = (*found.advice, "All before agrees: --end leaves out what followed, where it is a log.")
    return replace(found, sentence=f"in the last two minutes of driving, {found.sentence}", advice=advice)


def _found_in_part(seen: Seen) -> tuple[Finding, ...]:
    """Return what the checks find in one part of what was driven."""
    for check in FIRST:
        wrong = check.look(seen)
        if wrong is not None:
            return (wrong,)
    found: list[Finding] = []
    for check in THEN:
        if not any(each.spoils and each.kind in check.explained_by for each in found):
            seen_now = check.look(seen)
            found += [] if seen_now is None else [seen_now]
    return tuple(found)


def not_shown_yet(seen: Seen) -> str:
    """Say what is missing until a contradiction would have shown itself; empty where nothing is."""
    if not len(seen.evidence.measured_windows) and len(seen.evidence.gyro_turns):  # a gyro alone
        seconds = int(seen.evidence.gyro_turns[:, 1].sum())
        return "" if seconds >= ENOUGH else f"the gyro was compared over {seconds} of {ENOUGH} s of turns"
    found = seen.agreement(seen.input_name)
    if found.windows >= _LONG * ENOUGH:
        return ""
    windows = found.windows if seen.positions else min(found.windows, found.moving)
    if windows < ENOUGH:
        return f"poses were compared with {seen.words.name} over {windows} of {ENOUGH} stretches of 1.5 s"
    if found.turning < ENOUGH_TURN:
        return f"the robot was turned by {found.turning:.1f} of {ENOUGH_TURN:g} rad"
    return ""


def findings_of(
    log: Log, input_name: str, unknown_after: float = UNKNOWN_AFTER, *, sensor: Place = AT_CENTRE
) -> tuple[Finding, ...]:
    """Return what is wrong with poses and inputs of a log, where no learner has taken it.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel", the input that is learned from.
        unknown_after: an input is unknown once it is older than this [s].
        sensor: where the pose sensor is known to sit on the robot: x, y [m], yaw [rad].
    """
    return findings_of_each(log, (input_name,), unknown_after, sensor)


def findings_of_each(
    log: Log, inputs: Iterable[str], unknown_after: float, sensor: Place
) -> tuple[Finding, ...]:
    """Return what is wrong with poses and each of some inputs of a log; what no input changes, once."""
    found: list[Finding] = []
    before: Seen | None = None
    for name in inputs:
        seen = seen_in(log, name, unknown_after, sensor, before)
        checks = [check for check in WHOLE if before is None or check.of_input]
        first = findings_in(seen)
        found += (*first, *findings_of_others(log, name, unknown_after, first))
        found += looked_at(WholeLog(log, name, unknown_after), checks)
        before = seen
    return tuple(found)


def seen_in(
    log: Log, input_name: str, unknown_after: float, sensor: Place = AT_CENTRE, before: Seen | None = None
) -> Seen:
    """Return poses against inputs of a log; arguments as of `findings_of`, `before` of another input."""
    runs = [run for run in log.runs if has_input(run, input_name)]
    same = before is not None and runs == [run for run in log.runs if has_input(run, before.input_name)]
    gyro = has_course(log.runs)
    rates = [gyro_rows(run) for run in runs] if gyro else ()
    evidence = before.evidence if before is not None and same else None
    return Seen(
        evidence=evidence_of(runs, unknown_after, rates=rates) if evidence is None else evidence,
        runs=[run.name for run in runs],
        input_name=input_name,
        positions=has_course(log.runs),
        gyro=gyro,
        sensor=sensor,
        commanded=Commanded.of(runs),
    )


def findings_of_others(
    log: Log, input_name: str, unknown_after: float, first: Iterable[Finding]
) -> tuple[Finding, ...]:
    """Return what is wrong with poses of further sources beside the inputs, which was not `first` found.

    Where they sit and how they are turned on the robot is learned, and no fault.
    """
    kinds = {each.kind for each in first} | _OF_PLACE
    found: list[Finding] = []
    for source in dict.fromkeys(name for run in log.runs for name in run.others):
        runs = tuple(
            replace(run, poses=run.others[source], others={}) for run in log.runs if source in run.others
        )
        theirs = replace(log, runs=runs)
        wrong = findings_in(seen_in(theirs, input_name, unknown_after))
        wrong += looked_at(WholeLog(theirs, input_name, unknown_after), OF_SOURCE)
        new = [_of_source(each, source) for each in wrong if each.kind not in kinds]
        beside = None if any(each.spoils for each in new) else _BESIDE_FIRST.beside(source, log.runs)
        found += new if beside is None else (*new, beside)
    return tuple(found)


def _of_source(found: Finding, source: str) -> Finding:
    """Say of which source it is."""
    advice = (*found.advice, f"Or leave out {source}.")
    return replace(found, sentence=f"of the source {source}: {found.sentence}", advice=advice)


def findings_of_log(whole: WholeLog) -> tuple[Finding, ...]:
    """Return what only whoever has the whole log knows, such as how commands end."""
    return looked_at(whole, WHOLE)


def looked_at(whole: WholeLog, checks: Iterable[Check]) -> tuple[Finding, ...]:
    """Return what some checks find in a whole log, or in the last minutes of a stream."""
    looked = (check.look_at(whole) for check in checks)
    return tuple(found for found in looked if found is not None)


def has_input(run: Run, input_name: str) -> bool:
    """Whether a run has poses and an input of this kind."""
    inputs = run.commands if input_name == "command" else run.wheels
    return inputs is not None and len(inputs) > 0 and len(run.poses) > 0
