# SPDX-License-Identifier: Apache-2.0
"""Finds positions that drift while the wheels stand, as those of satellites do between walls and trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.held import rests
from slipwise.logs.log import Bools, Poses, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_STANDS = 1e-3  # m/s or rad/s
_LONG = 10.0  # s of standing
_SETTLED = 1.5  # s, until a robot stands whose wheels do
_MEAN = 1.0  # s; means over it show no noise
_FAR = 0.4  # m between two of them; real robots that stand drift by 0.3 m
_JUMP = 0.5  # of this way in one step is a jump, and no drifting
_TURN = 0.1  # rad; whoever turns is pushed


class DriftingPoses(Check):
    """Positions that go slowly away from a robot that stands."""

    kind, family, spoils = "drifting-poses", "poses", False
    hidden_by = ("two-sources", "unreachable-poses", "repeated-wheels")
    means = "positions drift while the robot stands: multipath of a satellite receiver; or it is pushed"
    shows = "while the wheels stand for 10 s and more, means over a second move by 0.4 m without a jump"
    cure = "the antenna's place and ground plane, fixed RTK solutions only"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at the poses while the wheels stand."""
        if not any(run.wheels for run in whole.log.runs):
            return None
        found = [rest for run in whole.log.runs for rest in _rests(run, whole.unknown_after)]
        if not found:
            return None
        far, seconds, place = max(found)
        return self.found(
            f"positions drift by {far:.2g} m in {seconds:.0f} s in which the wheels stand (from {place}): "
            "multipath of a satellite receiver, or somebody pushes the robot",
            "Look at the antenna's place and the kind of fix; errors of the model are no smaller than this.",
            evidence=far,
        )


def _rests(run: Run, unknown_after: float) -> list[tuple[float, float, str]]:
    """Return how far poses drifted [m], in how long [s], and from where on, of each time of standing."""
    w, p = run.wheels, run.poses
    if w is None or len(w) < 2 or len(p) < 2:
        return []
    found = []
    first, last = rests(w, _STANDS, unknown_after)
    for begin, end in zip(w.t[first].tolist(), w.t[last].tolist(), strict=True):
        at = (p.t > begin + _SETTLED) & (p.t < end)
        far = _drifted(p, at) if end - begin > _LONG else 0.0
        if far > _FAR:
            found.append((far, end - begin, run.place(begin)))
    return found


def _drifted(poses: Poses, at: Bools) -> float:
    """Return how far means over a second are apart [m]; 0 where one step, or a turn, makes it."""
    t, x, y, yaw = (column[at] for column in (poses.t, poses.x, poses.y, np.unwrap(poses.yaw)))
    if len(t) < 2 or len(np.unique(poses.frame[at])) != 1:
        return 0.0
    slot = np.floor((t - t[0]) / _MEAN).astype(int)
    count = np.bincount(slot)
    x, y, yaw = (np.bincount(slot, column)[count > 0] / count[count > 0] for column in (x, y, yaw))
    far = float(np.hypot(np.ptp(x), np.ptp(y)))
    jumps = bool((np.hypot(np.diff(x), np.diff(y)) > _JUMP * far).any())
    turns = not poses.course and float(np.ptp(yaw)) > _TURN
    return 0.0 if jumps or turns else far
