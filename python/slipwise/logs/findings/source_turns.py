# SPDX-License-Identifier: Apache-2.0
"""Finds two sources of poses that do not agree how far the robot turned, as odometry beside a lidar.

Wherever sensors sit on a robot and however they are turned, all of them turn by what it turns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.source_scale import seen_at
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from slipwise.logs.log import Floats, Poses, Run

_WINDOW = 5.0  # s
_FEWEST, _LEAST_TURN = 6, 3.0  # windows, and rad in total by either
_OUTLIER = 4.0  # times the usual error, from which on a window is left out
_ALIKE = 0.97  # correlation of turns: noise of one alone bends their ratio by 3 % then
_APART, _CERTAIN = 0.05, 6.0  # logarithm of the ratio, and its standard deviations,
_LEAST_STD = 0.002  # at least


class SourceTurns(Check):
    """Sources of poses that do not agree how far the robot turned."""

    kind, family = "source-turns", "poses"
    means = "two sources of poses turn by different angles: one is odometry, or its heading is scaled"
    shows = "over 5 s the turns of one are 5 % more than those of the other, by 6 deviations"
    cure = "name the one that is right, as for `source-scale`"

    def beside(self, name: str, runs: Sequence[Run]) -> Finding | None:
        """Compare a further source of some runs with their first."""
        pairs = [(run.poses, run.others[name]) for run in runs if name in run.others]
        turns = [_turns(*pair) for pair in pairs if not any(poses.course for poses in pair)]
        first, other = np.concatenate([np.empty((0, 2)), *turns]).T
        for _ in range(3):
            if len(first) < _FEWEST or min(np.abs(first).sum(), np.abs(other).sum()) < _LEAST_TURN:
                return None
            ratio = float(np.sqrt((other @ other) / (first @ first)))  # noise of either bends it the least
            off = np.abs(other - ratio * first)
            kept = off <= _OUTLIER * np.median(off)
            first, other, off = first[kept], other[kept], off[kept]
        std = float(np.sqrt(off @ off / (len(off) - 1) / (first @ first))) / ratio * (1.0 + 4.0 / len(off))
        std = max(std, _LEAST_STD)
        alike = float(first @ other / np.sqrt((first @ first) * (other @ other)))
        if alike < _ALIKE or abs(np.log(ratio)) <= max(_APART, _CERTAIN * std):
            return None
        named = next((run.source for run in runs if run.source), "") or "the first source"
        return self.found(
            f"{name} turns {estimate_text(ratio, ratio * std)} times as far as {named}: they cannot both be "
            "right, and what is learned lies in between",
            "The poses of an odometry say what its wheels do. Name the source that is right: --pose-topic or "
            "--poses once, or in a table only its rows.",
            evidence=ratio,
        )


def _turns(first: Poses, other: Poses) -> Floats:
    """Return what both turn [rad] in windows that both see, [N, 2]."""
    if min(len(first), len(other)) < 2:
        return np.empty((0, 2))
    begin, stop = max(first.t[0], other.t[0]), min(first.t[-1], other.t[-1])
    t = np.arange(begin, stop, _WINDOW)
    if len(t) < 2:
        return np.empty((0, 2))
    ends = np.stack((t[:-1], t[1:]), axis=1)
    known = [seen_at(first, pair) and seen_at(other, pair) for pair in ends]
    yaws = [np.interp(t, each.t, np.unwrap(each.yaw)) for each in (first, other)]
    return np.asarray(np.stack([np.diff(yaw) for yaw in yaws], axis=1)[np.array(known, dtype=bool)])
