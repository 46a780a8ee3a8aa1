# SPDX-License-Identifier: Apache-2.0
"""Finds the time in which a robot does not move although it is driven: stuck, stopped, or not localised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Bools, Floats
from slipwise.logs.motion_windows import MotionWindows, run_name

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

TURN_ARM = 0.3  # [m] at which a turn counts as distance
LEAST = 0.05  # [m] by the inputs in a window; slower driving may be inside a dead band
_PART = 0.3  # of the motion in fast windows, by the inputs; the same for robots that are slow on the whole
STILL = 0.1  # of the motion by the inputs; robots that skid or answer late move further
_STRETCH = 2.0  # [s] without a window ends a stretch
_SHORTEST = 2.5  # [s] a late answer may last for a shorter stretch
_SAID = 6.0  # [s] a stretch as long as this is said
_SPOILT = 0.2  # of the driven time; more makes the model one of a robot that does not move
_SHOWN = 3  # stretches


@dataclass(frozen=True)
class Stretch:
    """A stretch of one run in which the robot was driven and did not move."""

    run: int  # number of the run
    start: float  # [s] since the first pose of the run
    stop: float  # [s]
    still: float  # [s] in windows without motion

    def words(self, runs: Sequence[str]) -> str:
        """Say from when to when, and in which run where there are several."""
        where = f" of run {run_name(runs, self.run)}" if len(runs) > 1 else ""
        return f"{self.start:.1f} to {self.stop:.1f} s{where}"


class DoesNotMove(Check):
    """A robot that stands still for a part of the time that it is driven."""

    kind, family, reserves = "does-not-move", "drive", True
    means = "the robot does not move although it is driven: a stop, a blocked robot, a localiser that stood"
    shows = "poses move less than a tenth of the inputs for 6 s; no model is good from a fifth of the time on"
    cure = "look at the emergency stop and the localiser; `--start`, `--end` leave such a time out"
    explained_by = ("unlikely-speed",)
    hidden_by = ("two-sources", "frozen-poses", "unrelated")

    def look(self, seen: Seen) -> Finding | None:
        """Look for stretches of windows without motion."""
        windows, runs = seen.windows, seen.runs
        driven, still = _driven_and_still(windows)
        stretches = _stretches(windows, still)
        seconds = sum(stretch.still for stretch in stretches)
        driven_seconds = float(windows.duration[driven].sum())
        longest = max((stretch.still for stretch in stretches), default=0.0)
        spoils = seconds > _SPOILT * driven_seconds
        if longest < (_SHORTEST if spoils else _SAID):
            return None
        return self.found(
            f"the robot does not move although {seen.words.drives}, for {seconds:.1f} s of "
            f"{driven_seconds:.1f} s of driving",
            f"It stands still from {_places(stretches, runs)}.",
            "Look for an emergency stop, a blocked robot or a localiser that had stopped.",
            "--start and --end leave such a time out.",
            evidence=seconds,
            spoils=spoils,
        )


def _places(stretches: tuple[Stretch, ...], runs: Sequence[str]) -> str:
    """Say where the longest stretches are."""
    shown = sorted(stretches, key=lambda stretch: -stretch.still)[:_SHOWN]
    in_order = sorted(shown, key=lambda stretch: (stretch.run, stretch.start))
    more = f" and in {len(stretches) - _SHOWN} more stretches" if len(stretches) > _SHOWN else ""
    return ", ".join(stretch.words(runs) for stretch in in_order) + more


def _driven_and_still(windows: MotionWindows) -> tuple[Bools, Bools]:
    """Say in which windows the robot is driven, and in which of them it does not move, [N] each."""
    by_inputs = arm_motion(np.hypot(windows.forward, windows.sideways), windows.rotation)
    by_poses = arm_motion(windows.distance, windows.turn)
    fast = float(np.quantile(by_inputs, 0.9)) if len(windows) else 0.0
    driven = by_inputs > max(LEAST, _PART * fast)
    return driven, driven & (by_poses < STILL * by_inputs)


def arm_motion(distance: Floats, turn: Floats) -> Floats:
    """Return how far a robot moves [m], turns [rad] included."""
    return np.asarray(distance + TURN_ARM * np.abs(turn))


def _stretches(windows: MotionWindows, still: Bools) -> tuple[Stretch, ...]:
    """Join windows that follow each other; single windows are no stretch."""
    stretches: list[Stretch] = []
    for k in np.flatnonzero(still).tolist():
        run, seconds = int(windows.run[k]), float(windows.duration[k])
        start = float(windows.since[k])
        last = stretches[-1] if stretches else None
        if last is not None and last.run == run and 0.0 <= start - last.stop < _STRETCH:
            stretches[-1] = Stretch(run, last.start, start + seconds, last.still + seconds)
        else:
            stretches.append(Stretch(run, start, start + seconds, seconds))
    return tuple(stretch for stretch in stretches if stretch.still >= _SHORTEST)
