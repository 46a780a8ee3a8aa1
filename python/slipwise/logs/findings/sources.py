# SPDX-License-Identifier: Apache-2.0
"""Finds two publishers on one topic, by the same watch in a log and live."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.source_watch import SourceWatch
from slipwise.logs.log import Floats, Run

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

FAR_TWIST = (0.25, 0.25, 0.5)  # v, vy [m/s], omega [rad/s] between two samples of one robot
FAR_POSE = (0.75, 0.75)  # x, y [m]


def twist_watch() -> SourceWatch:
    """Return what watches speeds of wheels."""
    return SourceWatch(FAR_TWIST, relative=0.1)


def pose_watch() -> SourceWatch:
    """Return what watches positions."""
    return SourceWatch(FAR_POSE)


class TwoSources(Check):
    """Values of one topic that follow two courses in turn."""

    kind, family, spoils = "two-sources", "topics", False
    hidden_by = ("wheel-spikes",)  # that come often look like a second source
    means = "two nodes publish on one topic: two robots, two localisers, a controller and a filter"
    shows = "values take turns between two courses, each followed five times as closely as the other is near"
    cure = "`ros2 topic info -v` names them: remap one"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Watch wheels and poses until two speak."""
        for run in whole.log.runs:
            for what, watch, t, rows in _streams(run):
                first = watch.first(t, rows)
                if first is not None:
                    return self.on(what, run.place(first))
        return None

    @classmethod
    def on(cls, what: str, place: str = "") -> Finding:
        """Say on which topic, and where it shows first."""
        return cls.found(
            f"two sources speak on the {what} topic" + (f" in turn, first seen in {place}" if place else ""),
            "ros2 topic info -v names the publishers: remap one of them.",
        )


def _streams(run: Run) -> list[tuple[str, SourceWatch, Floats, Floats]]:
    poses = run.poses if run.poses.measured is None else run.poses.measured
    found = [("pose", pose_watch(), poses.t, np.column_stack((poses.x, poses.y)))]
    if run.wheels is not None:
        w = run.wheels
        found.append(("wheel", twist_watch(), w.t, np.column_stack((w.v, w.vy, w.omega))))
    return found
