# SPDX-License-Identifier: Apache-2.0
"""What will be measured: what a learner has to know before it is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from slipwise.calibration.settings_for_log import drives_sideways, has_attitude, has_known_force
from slipwise.logs.gyro import gyro_alone
from slipwise.logs.log import Log, Run, has_course
from slipwise.segments import source_names


@dataclass(frozen=True, kw_only=True)
class Coming:
    """What a learner has to know of the measurements that will come; all else follows from what arrives."""

    positions: bool = False  # poses come without a heading (`push_position`)
    gyro_alone: bool = False  # no poses come, and turns of a gyro are all that is learned from
    sources: tuple[str, ...] = ()  # of poses, where there are several or fixes differ; the first is judged by
    attitude: bool = False  # roll and pitch, or a known force: `auto` tries terms of gravity
    sideways: bool = False  # the robot drives sideways too: `auto` tries terms of its sideways speed

    def words(self) -> str:
        """Say what is particular, behind a sentence."""
        said = {
            "poses are positions, their headings the direction of the path": self.positions,
            "turns of a gyro are all that is measured": self.gyro_alone,
            f"poses of {', '.join(self.sources)}": len(self.sources) > 1,
            "with terms of gravity": self.attitude,
            "with terms of sideways speed": self.sideways,
        }
        return "".join(f"; {words}" for words, so in said.items() if so)

    def settings(self) -> dict[str, Any]:
        """Return what of it is not as the settings of [live] have it, where nothing is said there."""
        found = {
            name: getattr(self, name) or None for name in ("positions", "gyro_alone", "attitude", "sideways")
        }
        return found | {"sources": list(self.sources) or None}


def coming_of_runs(runs: Sequence[Run]) -> Coming:
    """Return what comes of poses and turns where these runs are learned; terms are chosen by `coming_of`."""
    return Coming(positions=has_course(runs), gyro_alone=gyro_alone(runs), sources=source_names(runs))


def coming_of(log: Log) -> Coming:
    """Return what comes where a log is replayed."""
    attitude = has_known_force(log) or has_attitude(log)
    return replace(coming_of_runs(log.runs), attitude=attitude, sideways=drives_sideways(log))
