# SPDX-License-Identifier: Apache-2.0
"""Finds poses and inputs of wrong units or in swapped columns, which logs are refused for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.input_units import likely_speeds, likely_turns
from slipwise.logs.log import Floats
from slipwise.logs.motion_windows import MotionWindows

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import InputWords, Seen

ENOUGH = 15  # windows; with fewer nothing is said
ENOUGH_TURN = 3.0  # [rad] in total
_TURN_TOGETHER = 0.5  # correlation of turns
_MOST_JUMPS = 0.3  # part of all steps; more jumps than this are no accident
_FEW_STEPS = 20  # with fewer no such judgement is made
_DEGREES = 180.0 / np.pi
_DEGREES_LOW, _DEGREES_HIGH = 0.3, 1.2  # poses turn so much of what inputs in degrees say
_LEAST_TURN, _MOST_TURN = 0.08, 10.0  # of the inputs' turns; real robots turn 0.13 to 4.5 times


@dataclass(frozen=True)
class Agreement:
    """How well poses and inputs agree; correlations are about 0 (1 at best), ratios 1 at best."""

    windows: int
    moving: int  # windows in which the robot moved enough to have a course
    turning: float  # [rad] total commanded turn
    yaw_inputs: float  # correlation of turns with the inputs' omega
    yaw_ratio: float  # measured turns over the inputs'
    yaw_degrees: float  # the two above if yaw is in degrees
    yaw_ratio_degrees: float
    yaw_v: float  # correlation of turns with the inputs' v
    distance_v: float  # correlation of distances with the inputs' speed
    distance_omega: float  # correlation of distances with the inputs' |omega|
    distance_ratio: float
    course: float  # mean cos 2(course - heading), 1 where the robot moves along its heading
    course_degrees: float  # the same if yaw is in degrees
    course_mirrored: float  # mean cos 2(course + heading), 1 for yaw clockwise, -1 for x and y swapped
    largest_yaw: float  # as measured, or by how much it changes in a window


def agreement(windows: MotionWindows) -> Agreement:
    """Compare poses and inputs over all windows of one kind of input."""
    w = windows
    speed = np.hypot(w.forward, w.sideways)
    usual = np.median(w.distance) if len(w) else 0.0
    moving = (w.distance > max(0.05, 0.5 * usual)) & (np.abs(w.rotation) < 2.0)
    body = np.arctan2(w.sideways, w.forward)
    heading = w.start_yaw + 0.5 * w.turn + body
    heading_degrees = np.radians(w.start_yaw + 0.5 * w.turn_degrees) + body
    mirrored = w.start_yaw + 0.5 * w.turn - body
    return Agreement(
        windows=len(w),
        moving=int(moving.sum()),
        turning=float(np.abs(w.rotation).sum()),
        yaw_inputs=correlation(w.turn, w.rotation),
        yaw_ratio=_ratio(w.turn, w.rotation),
        yaw_degrees=correlation(w.turn_degrees, w.rotation),
        yaw_ratio_degrees=_ratio(w.turn_degrees, w.rotation),
        yaw_v=correlation(w.turn, w.forward),
        distance_v=correlation(w.distance, speed),
        distance_omega=correlation(w.distance, np.abs(w.rotation)),
        distance_ratio=_ratio(w.distance, speed),
        course=_alignment((w.course - heading)[moving]),
        course_degrees=_alignment((w.course - heading_degrees)[moving]),
        course_mirrored=_alignment((w.course + mirrored)[moving]),
        largest_yaw=float(np.max(np.abs([w.start_yaw, w.turn_degrees]), initial=0.0)),
    )


class Implausible(Check):
    """Units, columns or axes that look wrong, of either input."""

    kind, family = "implausible", "signs and units"
    means = "degrees, a factor, swapped columns (v and omega, x and y), a sign of yaw, left and right swapped"
    shows = "turns and courses of the poses agree with the inputs only after the change that is named"
    cure = "`--wheel-scale 1,-1`, `--command-scale F,F`, or convert the column; the message says which"

    def look(self, seen: Seen) -> Finding | None:
        """Look at the input that is learned from, then at the other."""
        own, other = (seen.agreement(words.input_name) for words in (seen.words, seen.other_words))
        return self.of(own, seen.words, other) or self.of(other, seen.other_words, own)

    @classmethod
    def of(cls, agreed: Agreement, words: InputWords, other: Agreement) -> Finding | None:
        """Say which units, columns or axes look wrong, and what to do.

        Args:
            agreed: of one kind of input.
            words: how that is called.
            other: of the other kind, which may tell whether inputs or poses are wrong.
        """
        if agreed.windows < ENOUGH:
            return None
        alone = other.turning > ENOUGH_TURN and other.yaw_inputs > _TURN_TOGETHER
        mirrored = _mirrored(agreed, words, alone=alone)
        for what, advice in (_units(agreed, words), _swapped(agreed, words), mirrored):
            if what:
                return cls.found(what, advice, evidence=agreed.yaw_ratio)
        return None


class UnreachablePoses(Check):
    """Poses that jump further than any robot moves."""

    kind, family = "unreachable-poses", "poses"
    means = "most poses are out of reach of the inputs"
    shows = "more than 30 % of the steps between poses jump"
    cure = "units of poses (m, rad) and inputs (m/s, rad/s); `--pose-clock-offset auto`"

    def look(self, seen: Seen) -> Finding | None:
        """Count what the gate of poses rejected."""
        counts = seen.evidence.counts
        return self.of(counts.outliers + counts.jumps, counts.accepted + counts.outliers)

    @classmethod
    def of(cls, jumping: int, steps: int) -> Finding | None:
        """Say whether too many of the steps between poses jump further than the robot can have moved."""
        if steps < _FEW_STEPS or jumping <= _MOST_JUMPS * steps:
            return None
        return cls.found(
            "most poses are out of reach of the inputs",
            "check the units of poses (m, rad) and inputs (m/s, rad/s) and that their clocks agree",
            evidence=jumping / steps,
        )


_FINE = ("", "")


def _units(a: Agreement, words: InputWords) -> tuple[str, str]:
    turns = a.turning > ENOUGH_TURN
    by_turn = turns and abs(a.yaw_degrees) > 0.6 and a.yaw_ratio_degrees > 6.0
    by_course = a.moving >= ENOUGH and a.course_degrees > 0.8 and a.course < 0.4
    if a.largest_yaw > 7.0 and (by_turn or by_course):
        ratio = (
            f"{a.yaw_ratio_degrees:.0f} times the inputs' rate"
            if by_turn
            else "the course agrees with degrees"
        )
        return f"yaw looks like degrees ({ratio})", "convert the poses' angles to radians"
    if turns and abs(a.yaw_inputs) > 0.6 and not _LEAST_TURN < a.yaw_ratio < _MOST_TURN:
        return _rates(a, words)
    if a.distance_v > 0.6 and a.distance_ratio > 30.0:
        return (
            f"poses move {a.distance_ratio:.0f} times further than the {words.name} say",
            "use metres and m/s",
        )
    return _FINE


def _rates(a: Agreement, words: InputWords) -> tuple[str, str]:
    """Say how far yaw rates of the inputs, and their speeds with them, are off, and the option for that."""
    inputs = words.name
    moved, turned = a.distance_ratio, a.yaw_ratio
    if a.distance_v > 0.6 and not _LEAST_TURN < moved < _MOST_TURN:
        units = likely_speeds(moved)
        what = f"poses move {moved:.2g} times as far and turn {turned:.2g} times as much as the {inputs} say"
        both = f"multiplies both by the factor of the unit, about {moved:.2g}"
        return (
            f"{what}: they are not in m/s and rad/s" + (f", perhaps {units}" if units else ""),
            f"convert them: {words.scaled('F,F')} {both}",
        )
    units, factor = likely_turns(turned)
    what = f"poses turn {turned:.2g} times as much as omega of the {inputs} says"
    if _DEGREES_LOW < turned * _DEGREES < _DEGREES_HIGH:
        what = f"omega of the {inputs} looks like degrees per second (poses turn {turned:.3f} of it)"
        option = words.scaled(f"1,{1.0 / _DEGREES:.5f}")
        return what, f"convert it to rad/s: {option}; 1,{1.0 / 60.0:.5f} if it is in rad/min"
    return (
        f"{what}: it is not in rad/s" + (f", perhaps {units}" if units else ""),
        f"convert it: {words.scaled(f'1,{factor:.4g}')} multiplies it",
    )


def _swapped(a: Agreement, words: InputWords) -> tuple[str, str]:
    by_distance = a.distance_omega > max(0.7, a.distance_v + 0.1)
    by_turn = abs(a.yaw_v) > max(0.55, abs(a.yaw_inputs) + 0.2)
    if by_distance and by_turn and a.turning > ENOUGH_TURN:
        what = f"columns look swapped: v and omega of the {words.name}"
        advice = "distances follow omega and turns follow v; exchange the two columns"
        sides = ", or correct the sign of the wheels of one side, which count backwards"
        return what, advice + (sides if words.input_name == "wheel" else "")
    if a.moving >= ENOUGH and a.course < 0.3 and a.course_mirrored < -0.7:
        if a.yaw_inputs < -0.5:
            return "yaw looks like a compass heading", "use yaw = pi/2 - heading, counter-clockwise from x"
        what = "columns look swapped: x and y"
        return (
            what,
            "the course disagrees with yaw; exchange them, or use yaw = pi/2 - heading if it is a compass's",
        )
    return _FINE


def _mirrored(a: Agreement, words: InputWords, *, alone: bool) -> tuple[str, str]:
    """Say what turns against what; `alone`: the other input turns with the poses."""
    if a.moving >= ENOUGH and a.course < 0.3 and a.course_mirrored > 0.7:
        return "yaw runs clockwise while x and y do not", "change the sign of yaw"
    if a.turning <= ENOUGH_TURN or a.yaw_inputs >= -_TURN_TOGETHER:
        return _FINE
    swapped = "left and right are swapped, or " if words.input_name == "wheel" else ""
    sign = f"{swapped}the sign of omega is flipped: give {words.scaled('1,-1')}"
    if alone:
        return f"poses turn against the {words.name}", sign
    frame = "check the sign of yaw: it is counter-clockwise"
    if a.course > 0.5:
        frame = "poses are in a frame with z down: change the signs of y and yaw (x forward, y left, z up)"
    return "poses turn against the inputs", f"{frame}; or {sign}"


def correlation(a: Floats, b: Floats) -> float:
    """Return the correlation of two numbers about 0; 0 where one of them is 0 throughout."""
    scale = float(np.sqrt(np.sum(a * a) * np.sum(b * b)))
    return float(np.sum(a * b)) / scale if scale > 0.0 else 0.0


def _ratio(measured: Floats, expected: Floats) -> float:
    total = float(np.abs(expected).sum())
    return float(np.abs(measured).sum()) / total if total > 0.0 else 0.0


def _alignment(difference: Floats) -> float:
    return float(np.mean(np.cos(2.0 * difference))) if len(difference) else 0.0
