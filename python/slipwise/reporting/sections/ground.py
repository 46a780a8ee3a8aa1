# SPDX-License-Identifier: Apache-2.0
"""The ground along the drive: surfaces and changes found, slip by place, and the surfaces remembered."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from slipwise.calibration.learned_sequence import SurfaceSummary
from slipwise.calibration.result import History
from slipwise.models.schema import SurfaceSection
from slipwise.reporting.contents import Contents
from slipwise.reporting.ground_strip import UNNAMED, GroundStrip, strip_html
from slipwise.reporting.markup import grid, missing, paragraph, table
from slipwise.reporting.named_surfaces import named_surfaces
from slipwise.reporting.slip_place_map import place_maps
from slipwise.reporting.timeline import Timeline

PLACES = (
    "Slip by place: where the way was longer (blue) or shorter (red) than predicted, as a part of what was "
    "driven; the larger a square, the surer."
)


class GroundSection:
    """Did the ground change, and where?"""

    title = "The ground along the drive"
    explanation = (
        "Which stretches the model took for which ground, where it found a change, and what it did not "
        "expect at each place."
    )

    def html(self, contents: Contents) -> str:
        """Return the strip, the maps of slip by place and the table of surfaces, each where there is one."""
        history = contents.calibration.history
        horizon = min((part.horizon for part in contents.evaluation.predictions), default=None)
        part = contents.predictions(contents.learned_method, horizon)
        maps = place_maps(contents.log, part, key="place")
        surfaces = contents.calibration.model.content.surfaces
        rows = bank_table(surfaces) if surfaces else ""
        figures = [figure.html() for figure in maps]
        if not figures:
            return _strip(contents, history) + maps_html(figures) + rows
        beside = f'<div class="double">{_strip(contents, history)}</div>'
        return maps_html([beside, *figures]) + rows


def maps_html(figures: list[str]) -> str:
    """Return maps side by side, or why there is none."""
    if not figures:
        return missing(
            "The path does not run over the same ground again, so there is no map of slip by place."
        )
    return paragraph(PLACES, kind="explanation") + grid(figures)


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
