# SPDX-License-Identifier: Apache-2.0
"""Finds poses of a filter that takes in the wheels: they follow these at first, and the robot only later.

Such a filter (robot_localization, a localiser's pose that odometry carries on) adds to its pose what the
wheels say, and takes away a part of its error with every fix. Over a second its poses say that wheels do not
slip; over many they tell the truth. With a time constant T of its corrections and a share g of what the
wheels say that arrives, its pose and the wheels differ by (g - 1) times what the wheels say, with the lag T.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from slipwise.logs.findings.driven_steps import (
    DrivenSteps,
    Numbers,
    driven_steps,
    fit,
    lagged,
    left_by_body,
    turns,
    ways_to_turn,
)
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.pose_streams import told_by
from slipwise.logs.findings.seen import WORDS, WholeLog
from slipwise.logs.findings.standstill import LEAST, STILL, arm_motion
from slipwise.logs.log import has_course

_ENOUGH = 30  # windows of 1 s,
_TURNED = 1.0  # [rad^2] the sum of the squares of their turns,
_DRIVEN = 5.0  # [m^2] and of their ways
_TIMES = 2.0  # what any body leaves over what a filter leaves; real robots leave 1.65 times as much at most,
_TIMES_OF_COURSES = 1.5  # and 1.2 times where headings are courses, which hide more of the difference
_APART = 0.02  # between what arrives over a second and in the long run
_CORRECTED = (0.7, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 22.0)  # [s] time constants of corrections;
_QUICK = 1  # first of them that are not tried against commands, which a drive may follow so slowly
_LAGS_OF_DRIVES = (0.0, 0.2, 0.5)  # [s] of a robot that follows commands
_DELAYS = (0.0, 0.2, 0.4)  # [s] by which poses are late
_STOOD = 3  # windows in a row without motion: the robot stands


@dataclass(frozen=True)
class _Filter:
    """The filter that leaves least of the motion."""

    left: float  # sum of squares
    after: float  # [s] time constant of its corrections
    arrives: float  # of what the inputs say, in the long run


class FilteredPoses(Check):
    """Poses that follow the wheels' slips at once, and are corrected later."""

    kind, family = "filtered-poses", "poses"
    hidden_by = (
        *("two-sources", "repeated-wheels", "course-heading", "heading-jump"),
        *("unrelated", "implausible", "lost-sign", "towed-poses"),
    )
    means = "the poses are of a filter that takes in the wheels' odometry and is corrected slowly"
    shows = "over a second they follow the inputs by another share (2 %) than in the long run"
    cure = "record what corrects it: poses of the lidar, the receiver or the localiser"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare turns, and where there are wheels ways, with those of bodies and of such filters."""
        name = told_by(whole)
        drives = [_moving(each) for each in driven_steps(whole, name)]
        drives = [each for each in drives if each.chosen.any()]
        if sum(int(each.chosen.sum()) for each in drives) < _ENOUGH:
            return None
        course = has_course(whole.log.runs)
        motions = [] if course else [_Motion.turns_of(drives)]
        motions += (
            [_Motion.ways_of(drives, _TIMES_OF_COURSES if course else _TIMES)] if name == "wheel" else []
        )
        found = (self._found_in(motion, WORDS[name].name, name == "command") for motion in motions)
        return next((each for each in found if each is not None), None)

    def _found_in(self, motion: _Motion, inputs: str, commanded: bool) -> Finding | None:
        if not motion.enough():
            return None
        best, share = motion.best_filter(commanded), motion.share()
        if abs(share - best.arrives) < _APART or motion.left_by_body() < motion.times * best.left:
            return None
        return self.found(
            f"the poses follow the {inputs} at first and are corrected later, with a time constant of about "
            f"{best.after:.2g} s: over a second they {motion.does} {_percent(share)} of what the {inputs} "
            f"say, in the long run {_percent(best.arrives)}, as poses of a filter that takes in wheels do",
            "Record the poses that this filter is corrected with (lidar, GNSS, AMCL), not what it says.",
            "Or let it trust these more: as slow as it is, it hides slip.",
            evidence=best.after,
        )


@dataclass(frozen=True, eq=False)
class _Motion:
    """One motion of the poses in the G chosen windows of some runs, and what the inputs say of it."""

    does: str
    least: float  # sum of squares
    times: float  # what any body leaves over what a filter leaves, from which on it is one
    drives: Sequence[DrivenSteps]
    steps: Sequence[Numbers]  # by the inputs, [K] of each run
    measured: Numbers  # [G]
    also: Sequence[Numbers]  # what is a part of the motion besides, each [G]
    ways: Callable[[DrivenSteps, float], Sequence[Numbers]]  # that a body may take

    @classmethod
    def turns_of(cls, drives: Sequence[DrivenSteps]) -> _Motion:
        return cls(
            "turn", _TURNED, _TIMES, drives, [d.rotation for d in drives], turns(drives), (), ways_to_turn
        )

    @classmethod
    def ways_of(cls, drives: Sequence[DrivenSteps], times: float) -> _Motion:
        way, swing = (
            np.concatenate([getattr(d, name)[d.chosen] for d in drives]) for name in ("way", "swing")
        )
        return cls("go", _DRIVEN, times, drives, [d.path for d in drives], way, (swing,), _ways_along)

    def enough(self) -> bool:
        """Whether poses and inputs say that it moved."""
        return bool(min((np.abs(each) ** 2).sum() for each in (self.measured, self._said())) > self.least)

    def share(self) -> float:
        """Return what arrives of the inputs over a window."""
        return float(fit(np.column_stack((self._said(), *self.also)), self.measured)[1][0].real)

    def left_by_body(self) -> float:
        """Return the sum of squares that the best body leaves."""
        return left_by_body(self.drives, self.measured, self.ways, *self.also)

    def best_filter(self, commanded: bool) -> _Filter:
        """Return the filter whose motion is nearest; wheels may lag behind inputs that are `commanded`."""
        found = []
        for lag in _LAGS_OF_DRIVES if commanded else _LAGS_OF_DRIVES[:1]:
            wheels = [lagged(each, lag) for each in self.steps]
            for after in _CORRECTED[_QUICK:] if commanded else _CORRECTED:
                columns = [(each, lagged(each, after)) for each in wheels]
                found += [self._filter(columns, after, delay) for delay in _DELAYS]
        return min(found, key=lambda each: each.left)

    def _filter(self, columns: Sequence[tuple[Numbers, Numbers]], after: float, delay: float) -> _Filter:
        rows = [each.between(of_run, delay) for each, of_run in zip(self.drives, columns, strict=True)]
        at_once, later = np.concatenate(rows).T
        left, factors = fit(np.column_stack((later, *self.also)), self.measured - at_once)
        return _Filter(left, after, 1.0 + float(factors[0].real))

    def _said(self) -> Numbers:
        rows = [each.between((steps,)) for each, steps in zip(self.drives, self.steps, strict=True)]
        return np.asarray(np.concatenate(rows)[:, 0])


def _moving(drive: DrivenSteps) -> DrivenSteps:
    """Leave out stretches in which the robot stands although it is driven: poses of a filter would move."""
    every = replace(drive, chosen=np.ones_like(drive.chosen))
    way, turn = every.between((np.hypot(drive.forward, drive.sideways), np.abs(drive.rotation))).T
    by_inputs, by_poses = arm_motion(way, turn), arm_motion(np.abs(drive.way), drive.turn)
    still = (by_inputs > LEAST) & (by_poses < STILL * by_inputs)
    stood = np.zeros_like(still)
    for k in range(len(still) - _STOOD + 1):
        stood[k : k + _STOOD] |= still[k : k + _STOOD].all()
    return replace(drive, chosen=drive.chosen & ~stood)


def _ways_along(drive: DrivenSteps, lag: float) -> Sequence[Numbers]:
    path, turned = lagged(drive.path, lag), lagged(drive.rotation, lag)
    return path, path * np.abs(path), path * np.abs(turned), path * turned


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
