# SPDX-License-Identifier: Apache-2.0
"""Finds two publishers on one topic, by the same watch in a log and live."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.source_watch import SourceWatch
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
    of_input = True
    means = (
        "two nodes publish on one topic: two robots, two localisers, a controller and a filter, a driver and "
        "one that idles (from such commands no model is good)"
    )
    shows = (
        "values take turns between two courses, each followed five times as closely as the other is near; "
        "exact zeros between commands that come on time and are alike, and the robot goes on"
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
            driver = run.commands.select((run.commands.twists() != 0.0).any(axis=1))
            at = _interrupted(run.commands, driver)
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
