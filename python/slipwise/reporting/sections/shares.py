# SPDX-License-Identifier: Apache-2.0
"""What arrives of commands at the body: numbers, and pictures that show dead bands."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.rate_fits import Floats
from slipwise.calibration.shares import PoseSensor, commanded_to_body
from slipwise.logs.log import has_course
from slipwise.logs.motion_windows import evidence_of
from slipwise.models.share_words import AXES, SHARE_HEAD, axis_shares, share_rows, share_sentences
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import LEGEND_ON_TOP, Figure, axis, curve
from slipwise.reporting.markup import bullets, grid, missing, table
from slipwise.reporting.palette import LEARNED_STROKE, MEASURED


class SharesSection:
    """What arrives of commands?"""

    title = "What arrives of commands"
    explanation = "Windows of the log against the commands of the time; no model is asked."

    def html(self, contents: Contents) -> str:
        """Return the shares, and what each window says."""
        model = contents.calibration.model
        shares = axis_shares(model)
        if not shares:
            return missing("The log does not say it: it has no commands, or too few windows with them.")
        settings = model.content.provenance.settings.get("sensor_extrinsics")
        given = settings if isinstance(settings, dict) else {}
        windows = evidence_of(contents.log.runs, contents.unknown_after).windows
        y, yaw = (float(given.get(name, 0.0)) for name in ("y", "yaw"))
        sensor = PoseSensor(y, yaw, has_course(contents.log.runs))
        points = commanded_to_body(windows, sensor)
        figures = [
            _figure(name, points[name], shares[name].arrives.value).html()
            for name in shares
            if name in points
        ]
        return bullets(share_sentences(model)) + table(SHARE_HEAD, share_rows(model)) + grid(figures)


def _figure(name: str, points: tuple[Floats, Floats], share: float) -> Figure:
    commanded, body = points
    what, unit = AXES[name]
    ends = np.array((commanded.min(), commanded.max()))
    lines = (
        ("as commanded", ends, MEASURED, "dash"),
        (f"{100.0 * share:.0f} %", share * ends, LEARNED_STROKE.colour, "solid"),
    )
    return Figure(
        key=f"commanded-{name.replace('_', '-')}",
        label=f"{what} of the body over the commanded {what}",
        heading=f"{what[0].upper()}{what[1:]}",
        traces=[
            curve(
                commanded,
                body,
                mode="markers",
                name="windows",
                showlegend=False,
                marker={"size": 4, "color": LEARNED_STROKE.colour, "opacity": 0.5},
            ),
            *(
                curve(ends, values, name=label, line={"color": colour, "dash": dash, "width": 1.5})
                for label, values, colour, dash in lines
            ),
        ],
        layout={
            "xaxis": axis(f"commanded {what} [{unit}]"),
            "yaxis": axis(f"{what} of the body [{unit}]"),
            **LEGEND_ON_TOP,
        },
        height=280,
    )
