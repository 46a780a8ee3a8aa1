# SPDX-License-Identifier: Apache-2.0
"""Finds inputs without a yaw rate of a robot that turns: it is steered by another topic or column."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_TURN = 0.3  # [rad] by the poses in a window; less may be noise of headings
_EACH_WAY = 3.0  # [rad] by the poses in such windows, to either side; who veers does so to one
_NONE = 0.02  # of these turns, by the inputs


class MissingTurns(Check):
    """Inputs that drive straight on while the robot turns both ways."""

    kind, family = "missing-turns", "topics"
    means = "the yaw rate is not in the inputs: a column of zeros, or a topic of its own steers the robot"
    shows = "poses turn by 3 rad and more to both sides, inputs by less than 2 % of that"
    cure = "record the topic that steers, or fill the column (`cmd_omega`, `cmd_steer`, `odo_omega`)"
    explained_by = ("does-not-move", "parent-twist", "dead-wheel", "heading-jump", "lost-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Add up turns to either side of the way."""
        w = seen.windows
        if seen.positions:
            return None
        turns = (np.where(w.forward < 0.0, -1.0, 1.0) * w.turn)[np.abs(w.turn) > _TURN]
        left, right = float(turns[turns > 0.0].sum()), float(-turns[turns < 0.0].sum())
        given = float(np.abs(w.rotation).sum())
        if min(left, right) < _EACH_WAY or given > _NONE * (left + right):
            return None
        return self.found(
            f"the {seen.words.name} drive straight on while the robot turns to the left by {left:.0f} rad "
            f"and to the right by {right:.0f} rad: what steers it is not among them",
            "Record the topic that steers, or fill the column of the yaw rate.",
            evidence=left + right,
        )
