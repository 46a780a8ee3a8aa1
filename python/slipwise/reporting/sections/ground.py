# SPDX-License-Identifier: Apache-2.0
"""The ground along the drive: surfaces and changes found, and the surfaces remembered."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from slipwise.calibration.learned_sequence import SurfaceSummary
from slipwise.calibration.result import History
from slipwise.models.schema import SurfaceSection
from slipwise.reporting.contents import Contents
from slipwise.reporting.ground_strip import UNNAMED, GroundStrip, strip_html
from slipwise.reporting.markup import missing, paragraph, table
from slipwise.reporting.named_surfaces import named_surfaces
from slipwise.reporting.timeline import Timeline


class GroundSection:
    """Did the ground change, and where?"""

    title = "The ground along the drive"
    explanation = "Which stretches the model took for which ground, and where it found a change."

    def html(self, contents: Contents) -> str:
        """Return the strip and the table of surfaces, each where there is one."""
        surfaces = contents.calibration.model.content.surfaces
        rows = bank_table(surfaces) if surfaces else ""
        return _strip(contents, contents.calibration.history) + rows


def bank_table(surfaces: Iterable[SurfaceSummary | SurfaceSection]) -> str:
    """Return the table of surfaces that are remembered."""
    rows = [
        (
            each.name,
            f"{each.seconds / 60.0:.1f}",
            str(each.segments),
            str(each.visits),
            each.last_seen or "not said",
            f"{each.speed:.2f}",
            f"{each.yaw_rate:.2f}",
        )
        for each in surfaces
    ]
    head = ("surface", "driven [min]", "windows", "visits", "last", "speeds to [m/s]", "yaw rates to [rad/s]")
    return paragraph("Surfaces remembered:") + table(head, rows)


def _strip(contents: Contents, history: History | None) -> str:
    """The strip of one log, by surfaces or else by the alarms."""
    if history is None or not len(history.t):
        return missing("The model was not learned window by window, so no change of terrain was looked for.")
    timeline, course = Timeline.of(contents.log), history.surfaces
    if course is not None:
        names, probability = named_surfaces(course.names, course.probability, (), last="")
        names = tuple("the surface of this drive" if n == UNNAMED and len(names) == 1 else n for n in names)
    elif history.alarm.any():
        stretch = np.cumsum(history.alarm)  # from one alarm to the next
        probability = np.eye(int(stretch[-1]) + 1)[stretch]
        names = tuple(f"stretch {k + 1}" for k in range(len(probability.T)))
    else:
        return missing("No change of terrain was found: the whole drive seems to be on one ground.")
    x = timeline.at(history.run, history.t)
    alarms = tuple(x[np.flatnonzero(history.alarm)].tolist())
    strip = GroundStrip(x, names, probability, alarms, (), tuple(timeline.offset[1:].tolist()))
    return strip_html(strip, title=timeline.title)
