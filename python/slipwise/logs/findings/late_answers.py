# SPDX-License-Identifier: Apache-2.0
"""Finds wheels that answer commands later than planners and controllers take into account."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Inputs
from slipwise.logs.pose_clock import PoseMotion, agreements

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_STEP = 0.3  # s over which wheels are compared with commands
_LATEST = 3.0  # s that are tried
_TRIED = np.arange(-_LATEST, 0.05, 0.1)  # s added to the wheels
_LATE = 1.3  # s, from which on it is said: real drives take 1.1 s with their lag
_FIT, _BETTER = 0.7, 0.15  # least agreement, and by how much it beats that without a delay


class LateAnswers(Check):
    """Wheels that do what was commanded long ago."""

    kind, family, spoils = "late-answers", "drive", False
    of_input = True
    means = "the wheels answer commands later than a planner allows for: a queue, a slow bus, a slow drive"
    shows = "wheels and commands agree best with wheels 1.3 s earlier and more; real drives take up to 1.1 s"
    cure = (
        "find the queue (depth 1 for `cmd_vel`); `slipwise export --to mppi` writes the delay; drive slower"
    )

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Try delays up to 3 s."""
        if whole.input_name != "command":
            return None
        runs = [(run.commands, run.wheels) for run in whole.log.runs]
        pairs = [(c, w) for c, w in runs if c is not None and w is not None and min(len(c), len(w)) > 1]
        if not pairs or any(a.t[-1] >= b.t[0] for (_, a), (_, b) in itertools.pairwise(pairs)):
            return None
        motion = _motion([w for _, w in pairs], whole.unknown_after)
        fits = agreements([c for c, _ in pairs], motion, _TRIED, whole.unknown_after)
        best, none = int(np.argmax(fits)), float(fits[-1])
        late = -float(_TRIED[best])
        if late < _LATE or best == 0 or fits[best] < max(_FIT, none + _BETTER):
            return None
        return self.found(
            f"the wheels answer commands {late:.1f} s late: so both agree ({fits[best]:.2f}), and without a "
            f"delay they do not ({none:.2f})",
            "Look for a queue of commands (depth 1 for cmd_vel) or a slow bus; a planner must know what is "
            "left: slipwise export --to mppi writes it.",
            evidence=late,
        )


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
