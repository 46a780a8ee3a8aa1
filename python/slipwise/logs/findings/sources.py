# SPDX-License-Identifier: Apache-2.0
"""Finds two publishers on one topic, by the same watch in a log and live."""

from __future__ import annotations

import itertools
import math
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Inputs, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

FAR_TWIST = (0.25, 0.25, 0.5)  # v, vy [m/s], omega [rad/s] between two samples of one robot
FAR_POSE = (0.75, 0.75)  # x, y [m]
_ALIKE = (0.02, 0.1)  # m/s or rad/s, and of the value: two commands of one driver, one after the other
_IN_TIME = 1.5  # usual steps of a driver, within which the next command is not one after a zero of its own
_OFTEN = (20, 0.02)  # zeros between two commands that are alike, and of all commands to move
_LATELY = 1.0  # s after such a zero
_SLOWEST = 0.05  # m/s or rad/s; less is no command to move
_GOES_ON = 0.5  # of what is commanded beside the zeros, from which on the robot does not obey them
LOOKED_AT = 40  # newest values
FEWEST = 8  # times that the courses take turns among these; an outlier is two
PLACEHOLDERS = 0.25  # of these, at most; so many that are one value to the bit stand for "none measured"
APART = 5.0  # how many times farther the other course is than the own one, where these are two sources
CLOSED_FOR = 5.0  # s after two sources were seen last


def twist_watch() -> SourceWatch:
    """Return what watches speeds of wheels."""
    return SourceWatch(FAR_TWIST, relative=0.1)


def pose_watch() -> SourceWatch:
    """Return what watches positions."""
    return SourceWatch(FAR_POSE)


class TwoSources(Check):
    """Values of one topic that follow two courses in turn."""

    kind, family, spoils = "two-sources", "topics", False
    hidden_by = ("wheel-spikes",)  # that come often look like a second source
    means = (
        "two nodes publish on one topic: two robots, two localisers, or a driver and one that idles "
        "(no model is good)"
    )
    shows = (
        "values take turns between two courses; exact zeros between commands that are alike, and the robot "
        "goes on"
    )
    cure = "`ros2 topic info -v` names them: remap one"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Watch wheels and poses until two speak, and look for zeros among commands."""
        for run in whole.log.runs:
            for what, watch, t, rows in _streams(run):
                first = watch.first(t, rows)
                if first is not None:
                    return self.on(what, run.place(first))
        return IdleSource().look_at(whole)

    @classmethod
    def on(cls, what: str, place: str = "") -> Finding:
        """Say on which topic, and where it shows first."""
        return cls.found(
            f"two sources speak on the {what} topic" + (f" in turn, first seen in {place}" if place else ""),
            "ros2 topic info -v names the publishers: remap one of them.",
        )


class IdleSource(TwoSources):
    """Commands between which another node sends zeros that the robot does not obey."""

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look for zeros between commands that are alike, where commands are learned from."""
        if whole.input_name != "command":
            return None
        zeros, moves, asked, done, place = 0, 0, 0.0, 0.0, ""
        for run in whole.log.runs:
            if run.commands is None or len(run.commands) < 2:
                continue
            sent = run.commands.sent
            driver = sent.select((sent.twists() != 0.0).any(axis=1))
            at = _interrupted(sent, driver)
            motion = CommandedMotion.between(driver, run.poses)
            zeros, moves = zeros + len(at), moves + len(driver)
            if len(at) and motion is not None:
                place = place or run.place(float(at[0]))
                parts = _asked_and_done(motion, at, whole.unknown_after)
                asked, done = asked + parts[0], done + parts[1]
        if zeros < max(_OFTEN[0], _OFTEN[1] * moves) or done < _GOES_ON * asked or not asked:
            return None
        return self.found(
            f"two sources speak on the command topic, first seen in {place}: one sends zeros, {zeros} times "
            "between two commands that are alike, and the robot goes on",
            "ros2 topic info -v names the publishers: remap one of them, or record what the multiplexer of "
            "the robot gives out.",
            evidence=zeros,
            spoils=True,
        )


def _interrupted(commands: Inputs, driver: Inputs) -> Floats:
    """Return when [s] zeros stood before a command that is on time and like the one before the zeros."""
    steps = np.diff(driver.t)
    if not len(steps):
        return np.empty(0)
    between = np.diff(np.searchsorted(commands.t, driver.t)) > 1
    rows = driver.twists()
    alike = (np.abs(np.diff(rows, axis=0)) <= _ALIKE[0] + _ALIKE[1] * np.abs(rows[1:])).all(axis=1)
    return np.asarray(driver.t[1:][between & alike & (steps <= _IN_TIME * np.median(steps))])


def _asked_and_done(motion: CommandedMotion, at: Floats, unknown_after: float) -> tuple[float, float]:
    """Return how far the driver asked for and the robot went [m and rad together], after zeros came."""
    middle = motion.middle
    held = np.searchsorted(motion.t, middle, side="right") - 1
    newest = np.searchsorted(at, middle, side="right") - 1
    late = np.where(newest >= 0, middle - at[newest], np.inf)
    near = (late < _LATELY) & (middle - motion.t[held] < unknown_after)
    given, moved = motion.given[held][near], motion.moved[near]
    counts = (np.abs(given) > _SLOWEST) & np.isfinite(moved)
    return float(np.abs(given[counts]).sum()), float((np.sign(given[counts]) * moved[counts]).sum())


def _streams(run: Run) -> list[tuple[str, SourceWatch, Floats, Floats]]:
    poses = run.poses.as_measured
    found = [("pose", pose_watch(), poses.t, np.column_stack((poses.x, poses.y)))]
    if run.wheels is not None:
        found.append(("wheel", twist_watch(), run.wheels.t, run.wheels.twists()))
    return found


@dataclass
class _Course:
    value: tuple[float, ...]
    number: int  # of the last value on it


class _Assigned(NamedTuple):
    first: bool  # which course it is on
    turned: bool  # whether the value before it is on the other one
    own: float  # how far from its course, in units of `far`
    other: float


class SourceWatch:
    """Puts every value on the nearer of two courses. Noise and outliers make no second one that is apart.

    Args:
        far: how far apart values of one source, sampled one after the other, hardly ever are, [K] each.
        relative: the same as a fraction of the values, where that is more.
    """

    def __init__(self, far: tuple[float, ...], *, relative: float = 0.0) -> None:
        self._far, self._relative = far, relative
        self._courses: list[_Course] = []
        self._assigned: deque[_Assigned] = deque(maxlen=LOOKED_AT)
        self._count, self._turns = 0, 0  # values, and those of `_assigned` behind one on the other course
        self._until = -math.inf

    def take(self, t: float, values: tuple[float, ...]) -> bool:
        """Take a value [K] at its stamp [s]; return whether two sources speak now."""
        if all(map(math.isfinite, values)):
            self._count += 1
            self._assign(values)
            if self._assigned and self._assigned[-1].other > 1.0 and self._two():
                self._until = t + CLOSED_FOR
        return t < self._until

    def first(self, t: Floats, rows: Floats) -> float | None:
        """Return the first stamp [s] at which two sources speak, as `take` would say; None where one does.

        Args:
            t: [N] stamps.
            rows: [N, K] finite values. Until one is far from that before it, all are on one course.
        """
        far = np.maximum(self._far, self._relative * np.abs(rows[1:]))
        jumps = np.flatnonzero((np.abs(np.diff(rows, axis=0)) / far > 1.0).any(axis=1))
        if not len(jumps):
            return None
        rest = zip(t[jumps[0] :].tolist(), rows[jumps[0] :].tolist(), strict=True)
        return next((stamp for stamp, row in rest if self.take(stamp, tuple(row))), None)

    def _assign(self, value: tuple[float, ...]) -> None:
        far = [max(least, self._relative * abs(each)) for least, each in zip(self._far, value, strict=True)]
        apart = []
        for course in self._courses:
            most = 0.0
            for one, other, usual in zip(value, course.value, far, strict=True):
                most = max(most, abs(one - other) / usual)
            apart.append(most)
        if len(apart) < 2 and (not apart or apart[0] > 1.0):
            self._courses.append(_Course(value, self._count))
            return
        nearer = apart.index(min(apart))
        if len(apart) == 2 and apart[nearer] > 1.0:  # near none: it replaces the one that was left longer ago
            nearer = int(self._courses[0].number > self._courses[1].number)
        self._courses[nearer] = _Course(value, self._count)
        if len(apart) == 2:
            self._note(nearer == 0, apart[nearer], apart[1 - nearer])

    def _note(self, first: bool, own: float, other: float) -> None:
        """Keep what a value was assigned to, and how often the newest ones took turns."""
        newest = self._assigned
        if len(newest) == LOOKED_AT:
            self._turns -= newest[1].turned
        newest.append(_Assigned(first, bool(newest) and newest[-1].first != first, own, other))
        self._turns += newest[-1].turned

    def _two(self) -> bool:
        """Whether the courses take turns, and each is followed far more closely than the other is near."""
        if self._turns < FEWEST or self._placeholders():
            return False
        left = [before.other for before, after in itertools.pairwise(self._assigned) if after.turned]
        own = np.array([each.own for each in self._assigned])
        followed = float(np.quantile(own, 0.9)) <= 0.5
        return followed and bool(np.median(left) > max(2.0, APART * float(np.quantile(own, 0.75))))

    def _placeholders(self) -> bool:
        """Whether the rarer course is one value to the bit: outliers, which are left out, and no source."""
        on_first = sum(each.first for each in self._assigned)
        rarer = 2 * on_first <= len(self._assigned)
        own = [each.own for each in self._assigned if each.first is rarer]
        return len(own) <= PLACEHOLDERS * LOOKED_AT and not any(own)
