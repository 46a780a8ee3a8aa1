# SPDX-License-Identifier: Apache-2.0
"""Finds wheels that answer commands later than planners take into account, or before they come."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Inputs
from slipwise.logs.pose_clock import PoseMotion, agreements

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_STEP = 0.3  # s over which wheels are compared with commands
_FAR = 3.0  # s that are tried, either way
_TRIED = np.arange(-_FAR, _FAR + 0.05, 0.1)  # s added to the wheels
_LONGEST = _FAR - 0.05
_LATE, _EARLY = 1.3, 0.25  # s, from which on it is said: real drives take 1.1 s with their lag
_FIT = 0.7  # least agreement, and by how much it beats that without an offset:
_BETTER, _BETTER_EARLY = 0.15, 0.05  # no drive answers before


class LateAnswers(Check):
    """Wheels that do what was commanded long ago."""

    kind, family, spoils = "late-answers", "drive", False
    of_input = True
    means = "the wheels answer commands late: a queue, a slow bus, a slow drive"
    shows = "wheels and commands agree best with wheels 1.3 s earlier and more; real drives take up to 1.1 s"
    cure = (
        "find the queue (depth 1 for `cmd_vel`); `slipwise export --to mppi` writes the delay; drive slower"
    )

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Try delays up to 3 s."""
        best = _best_answer(whole)
        if best is None or not _LATE <= -best.offset < _LONGEST:
            return None
        return self.found(
            f"the wheels answer commands {-best.offset:.1f} s late: so both agree ({best.fit:.2f}), and "
            f"without a delay they do not ({best.none:.2f})",
            "Look for a queue of commands (depth 1 for cmd_vel) or a slow bus; a planner must know what is "
            "left: slipwise export --to mppi writes it.",
            evidence=-best.offset,
        )


class EarlyAnswers(Check):
    """Wheels that do what is commanded only later."""

    kind, family = "early-answers", "clocks"
    of_input = True
    means = "commands are stamped after they were carried out"
    shows = "both agree best with wheels 0.3 s later and more"
    cure = "stamp commands when they are sent; else `--input wheel`"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Try up to 3 s."""
        best = _best_answer(whole)
        if best is None or not _EARLY <= best.offset < _LONGEST:
            return None
        return self.found(
            f"the wheels do what is commanded {best.offset:.1f} s before it is: so both agree best "
            f"({best.fit:.2f}, as they are stamped {best.none:.2f})",
            "Stamp commands when they are sent, by the clock of the wheels; or learn from the wheels "
            "(--input wheel).",
            evidence=best.offset,
        )


@dataclass(frozen=True)
class _Answer:
    """At what time wheels do what is commanded."""

    offset: float  # s added to the wheels
    fit: float  # agreement with it,
    none: float  # and without


@lru_cache(maxsize=1)  # both checks look at one log in turn
def _best_answer(whole: WholeLog) -> _Answer | None:
    """Return at what time both agree; None where they do not, or no better than without an offset."""
    if whole.input_name != "command":
        return None
    runs = [(run.commands, run.wheels) for run in whole.log.runs]
    pairs = [(c, w) for c, w in runs if c is not None and w is not None and min(len(c), len(w)) > 1]
    if not pairs or any(a.t[-1] >= b.t[0] for (_, a), (_, b) in itertools.pairwise(pairs)):
        return None
    motion = _motion([w for _, w in pairs], whole.unknown_after)
    fits = agreements([c for c, _ in pairs], motion, _TRIED, whole.unknown_after)
    best, none = int(np.argmax(fits)), float(fits[len(_TRIED) // 2])
    offset = float(_TRIED[best])
    if fits[best] < max(_FIT, none + (_BETTER if offset < 0.0 else _BETTER_EARLY)):
        return None
    return _Answer(offset, float(fits[best]), none)


def _motion(wheels: Sequence[Inputs], unknown_after: float) -> PoseMotion:
    """Return the motion of the wheels of each run, as if it had been seen between poses."""
    parts = []
    for own in wheels:
        start = np.arange(own.t[0], own.t[-1] - _STEP, _STEP)
        stop = start + _STEP
        columns = (np.hypot(own.v, own.vy), own.omega)
        means = (HeldSum.of(own, each, unknown_after).between(start, stop) / _STEP for each in columns)
        parts.append((start, stop, *means))
    return PoseMotion(*(np.concatenate(column) for column in zip(*parts, strict=True)))
