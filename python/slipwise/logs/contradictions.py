# SPDX-License-Identifier: Apache-2.0
"""All that shows poses and inputs to contradict each other, for the input that is learned from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from slipwise import _core
from slipwise.logs.command_timeout import stops_of
from slipwise.logs.contradiction import Contradiction
from slipwise.logs.course_heading import course_heading
from slipwise.logs.driven_windows import driven_windows
from slipwise.logs.gyro import gyro_contradiction, left_out_gyros
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Log, Run, has_course
from slipwise.logs.motion_windows import MotionWindows, evidence_of, motion_windows
from slipwise.logs.plausibility import ENOUGH, ENOUGH_TURN, Agreement, agreement, implausible, unreachable
from slipwise.logs.repeated_wheels import repeated_wheels
from slipwise.logs.standstill import standstill
from slipwise.logs.turned_poses import COMMANDS, WHEELS, lost_heading, turned_heading, unlikely_speed

_CAUSES = {"command": "it is commanded", "wheel": "its wheels turn"}
_WORDS = {"command": COMMANDS, "wheel": WHEELS}
_OTHER = {"command": "wheel", "wheel": "command"}
_LONG = 4  # times as many windows suffice of a robot that hardly turns, or only turns


@dataclass(frozen=True, eq=False)
class Seen:
    """What is looked at for contradictions."""

    evidence: _core.MotionEvidence | _core.RecentEvidence
    runs: Sequence[str]  # names, by the evidence's number of the run
    input_name: str  # "command" or "wheel", the input that is learned from
    positions: bool  # headings are courses, which tell nothing of a heading
    gyro: bool  # turns of a gyro are learned from
    sensor_yaw: float  # how the pose sensor is known to be turned on the robot [rad]

    def windows(self, input_name: str) -> MotionWindows:
        """Return those of one kind of input, between poses that a learner uses."""
        return motion_windows(self.evidence.windows, input_name)

    def agreement(self, input_name: str) -> Agreement:
        """Say how well one kind of input agrees with the poses as they were measured."""
        return agreement(motion_windows(self.evidence.measured_windows, input_name))


def contradictions_in(seen: Seen) -> tuple[Contradiction, ...]:
    """Return what shows that poses and inputs cannot both be right, in all that was driven or lately.

    An hour of good driving hides a localiser that freezes or a sign that flips: the last two minutes of
    driving are judged by the same rules.
    """
    found = _contradictions_in_part(seen)
    recent = seen.evidence.recent if isinstance(seen.evidence, _core.MotionEvidence) else None
    if recent is None or any(each.spoils for each in found):
        return found
    lately = _contradictions_in_part(replace(seen, evidence=recent))
    spoilt = tuple(_lately(each) for each in lately if each.spoils)
    kinds = {each.kind for each in spoilt}
    return (*spoilt, *(each for each in found if each.kind not in kinds))


def _lately(found: Contradiction) -> Contradiction:
    """Say that it is so of the last minutes alone."""
    advice = (*found.advice, "All before agrees: --end leaves out what followed, where it is a log.")
    return replace(found, sentence=f"in the last two minutes of driving, {found.sentence}", advice=advice)


def _contradictions_in_part(seen: Seen) -> tuple[Contradiction, ...]:
    """Return what the rules say of one part of what was driven."""
    wrong = _wrong_units(seen)
    if wrong is not None:  # what else looks wrong comes from it
        return (wrong,)
    windows, words = seen.windows(seen.input_name), _WORDS[seen.input_name]
    driven = driven_windows(windows, seen.sensor_yaw)
    speed = unlikely_speed(driven, words)
    still = None if speed is not None else standstill(windows, seen.runs, _CAUSES[seen.input_name])
    gyro = gyro_contradiction(seen.evidence.gyro_turns, seen.runs) if seen.gyro else None
    found = [speed, still, gyro]
    if not seen.positions and (still is None or not still.spoils):
        others = driven_windows(seen.windows(_OTHER[seen.input_name]), seen.sensor_yaw)
        alone = others.direction.real > 0.5
        course = course_heading(windows, seen.sensor_yaw)
        found.append(course)
        if course is None:  # what else a heading seems to do would come from it
            found.append(turned_heading(driven, words, alone=alone))
            found.append(lost_heading(windows, driven, words))
    found.append(repeated_wheels(seen.evidence))
    return tuple(each for each in found if each is not None)


def _wrong_units(seen: Seen) -> Contradiction | None:
    """Find a unit, a column or an axis that is wrong, as the door of a log does."""
    for name in (seen.input_name, _OTHER[seen.input_name]):
        found = implausible(seen.agreement(name), _WORDS[name].name)
        if found is not None:
            return found
    counts = seen.evidence.counts
    return unreachable(counts.outliers + counts.jumps, counts.accepted + counts.outliers)


def not_shown_yet(seen: Seen) -> str:
    """Say what is missing until a contradiction would have shown itself; empty where nothing is."""
    if not len(seen.evidence.measured_windows) and len(seen.evidence.gyro_turns):  # a gyro alone
        seconds = int(seen.evidence.gyro_turns[:, 1].sum())
        return "" if seconds >= ENOUGH else f"the gyro was compared over {seconds} of {ENOUGH} s of turns"
    found, words = seen.agreement(seen.input_name), _WORDS[seen.input_name]
    if found.windows >= _LONG * ENOUGH:
        return ""
    windows = found.windows if seen.positions else min(found.windows, found.moving)
    if windows < ENOUGH:
        return f"poses were compared with {words.name} over {windows} of {ENOUGH} stretches of 1.5 s"
    if found.turning < ENOUGH_TURN:
        return f"the robot was turned by {found.turning:.1f} of {ENOUGH_TURN:g} rad"
    return ""


def contradictions(
    log: Log, input_name: str, unknown_after: float = UNKNOWN_AFTER, *, sensor_yaw: float = 0.0
) -> tuple[Contradiction, ...]:
    """Return what shows that poses and inputs of a log cannot both be right, where no learner has taken it.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel", the input that is learned from.
        unknown_after: an input is unknown once it is older than this [s].
        sensor_yaw: how the pose sensor is known to be turned on the robot [rad].
    """
    runs = [run for run in log.runs if _has(run, input_name)]
    seen = Seen(
        evidence=evidence_of(runs, unknown_after),
        runs=[run.name for run in runs],
        input_name=input_name,
        positions=has_course(log.runs),
        gyro=False,
        sensor_yaw=sensor_yaw,
    )
    return (*contradictions_in(seen), *contradictions_of_log(log, input_name, unknown_after))


def contradictions_of_log(
    log: Log, input_name: str, unknown_after: float = UNKNOWN_AFTER
) -> tuple[Contradiction, ...]:
    """Return what only whoever has the whole log knows: what was left out of it, and how commands end."""
    ended = _ended_commands(log, unknown_after) if input_name == "command" else None
    return (*left_out_gyros(log.runs), *(() if ended is None else (ended,)))


def _ended_commands(log: Log, unknown_after: float) -> Contradiction | None:
    """Say where the robot stops between commands that are taken to be held."""
    pairs = [
        (run.commands, run.poses) for run in log.runs if run.commands is not None and _has(run, "command")
    ]
    return stops_of(pairs).contradiction(unknown_after)


def _has(run: Run, input_name: str) -> bool:
    inputs = run.commands if input_name == "command" else run.wheels
    return inputs is not None and len(inputs) > 0 and len(run.poses) > 0
