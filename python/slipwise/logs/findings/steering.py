# SPDX-License-Identifier: Apache-2.0
"""Finds robots of which a wheelbase was given though they do not steer: lags were learned of a curvature."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.models.axes import sideways_span

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen
    from slipwise.logs.log import Run

_STANDS = 0.05  # [m] in a window at most, by the commands and by the poses
_TURNS = 0.2  # [rad] in it at least, by both, to one side
_ENOUGH = 5  # windows


@dataclass(frozen=True)
class Commanded:
    """What the commands of a robot are, beside speeds."""

    steered: bool = False  # a wheelbase was given with them
    sideways: bool = False  # they drive the robot sideways
    throttle: bool = False  # they are throttle and steering, which have no units

    @classmethod
    def of(cls, runs: Sequence[Run]) -> Commanded:
        """Look at the commands of all runs."""
        commands = [run.commands for run in runs if run.commands is not None]
        return cls(
            steered=any(each.wheelbase is not None for each in commands),
            sideways=driven_sideways(runs),
            throttle=any(each.car is not None for each in commands),
        )


class NotSteered(Check):
    """Commands with a wheelbase that no robot which steers can follow."""

    kind, family = "not-steered", "drive"
    means = "a wheelbase is given, and the robot does not steer: it has no delay and lag of a steering"
    shows = "commands drive it sideways; or it turns on the spot as it is commanded, by 0.2 rad in 5 windows"
    cure = "leave `--wheelbase` away"

    def look(self, seen: Seen) -> Finding | None:
        """Look for sideways commands, and for turns at standstill."""
        if not seen.commanded.steered or seen.input_name != "command":
            return None
        if seen.commanded.sideways:
            return self.of_sideways()
        w = seen.windows
        stands = (np.hypot(w.forward, w.sideways) < _STANDS) & (w.distance < _STANDS)
        turns = np.minimum(np.sign(w.rotation) * w.turn, np.abs(w.rotation)) > _TURNS
        count = int((stands & turns).sum())
        if seen.positions or count < _ENOUGH:
            return None
        return self.found(
            f"the robot turns on the spot as it is commanded ({count} stretches of 1.5 s), and a wheelbase "
            "is of one that steers",
            _ADVICE,
            evidence=count,
        )

    @classmethod
    def of_sideways(cls) -> Finding:
        """Say it of commands to the side."""
        return cls.found("commands drive the robot sideways, and a wheelbase is of one that steers", _ADVICE)


_ADVICE = "leave the wheelbase away"


def driven_sideways(runs: Iterable[Run]) -> bool:
    """Whether the commands of some run drive the robot sideways."""
    given = (run.commands for run in runs if run.commands is not None)
    return any(sideways_span(commands.v, commands.vy) is not None for commands in given)
