# SPDX-License-Identifier: Apache-2.0
"""Finds the time in which a robot does not move although it is driven: stuck, stopped, or not localised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise.logs.contradiction import Contradiction
from slipwise.logs.log import Bools, Floats
from slipwise.logs.motion_windows import MotionWindows, run_name

TURN_ARM = 0.3  # [m] at which a turn counts as distance
_LEAST = 0.05  # [m] by the inputs in a window; slower driving may be inside a dead band
_PART = 0.3  # of the motion in fast windows, by the inputs; the same for robots that are slow on the whole
_STILL = 0.1  # of the motion by the inputs; robots that skid or answer late move further
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


def standstill(windows: MotionWindows, runs: Sequence[str], cause: str) -> Contradiction | None:
    """Say whether the robot stands still for a part of the time that it is driven.

    Args:
        windows: of one kind of input.
        runs: names, by the number of the run in `windows`.
        cause: what drives it, such as "it is commanded".
    """
    driven, still = _driven_and_still(windows)
    stretches = _stretches(windows, still)
    seconds = sum(stretch.still for stretch in stretches)
    driven_seconds = float(windows.duration[driven].sum())
    longest = max((stretch.still for stretch in stretches), default=0.0)
    spoils = seconds > _SPOILT * driven_seconds
    if longest < (_SHORTEST if spoils else _SAID):
        return None
    shown = sorted(stretches, key=lambda stretch: -stretch.still)[:_SHOWN]
    in_order = sorted(shown, key=lambda stretch: (stretch.run, stretch.start))
    places = ", ".join(stretch.words(runs) for stretch in in_order)
    more = f" and in {len(stretches) - _SHOWN} more stretches" if len(stretches) > _SHOWN else ""
    return Contradiction(
        "does-not-move",
        f"the robot does not move although {cause}, for {seconds:.1f} s of {driven_seconds:.1f} s of driving",
        (
            f"It stands still from {places}{more}.",
            "Look for an emergency stop, a blocked robot or a localiser that had stopped.",
            "--start and --end leave such a time out.",
        ),
        spoils,
    )


def _driven_and_still(windows: MotionWindows) -> tuple[Bools, Bools]:
    """Say in which windows the robot is driven, and in which of them it does not move, [N] each."""
    by_inputs = _motion(np.hypot(windows.forward, windows.sideways), windows.rotation)
    by_poses = _motion(windows.distance, windows.turn)
    fast = float(np.quantile(by_inputs, 0.9)) if len(windows) else 0.0
    driven = by_inputs > max(_LEAST, _PART * fast)
    return driven, driven & (by_poses < _STILL * by_inputs)


def _motion(distance: Floats, turn: Floats) -> Floats:
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
