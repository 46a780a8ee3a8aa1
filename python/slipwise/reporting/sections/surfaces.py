# SPDX-License-Identifier: Apache-2.0
"""The learned slip over speed and yaw rate, and where the log holds both."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.models.model import Model
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import Figure
from slipwise.reporting.markup import grid, missing
from slipwise.reporting.sections.coverage import coverage_figure
from slipwise.reporting.slip_figures import CHANNELS, NODES, SlipGrid, contour_map


class SurfacesSection:
    """What slip did the model learn, and where?"""

    title = "Learned slip, and the speeds and yaw rates driven"
    explanation = (
        "Rates added to the motion on level terrain: red takes away, blue adds. Not known outside the dashed "
        "box."
    )

    def html(self, contents: Contents) -> str:
        """Return a map for each channel of slip, and the histogram of inputs."""
        driven = coverage_figure(contents)
        name = "wheel speeds" if contents.evaluation.input == "wheel" else "commands"
        absent = [] if driven else [f"The log has no {name}, so there is no plane of inputs to cover."]
        maps, sentences = _slip(contents.calibration.model)
        shown = [*maps, *([driven] if driven else [])]
        drawn = grid(figure.html() for figure in shown) if shown else ""
        return drawn + "".join(missing(text) for text in (*sentences, *absent))


def _slip(model: Model) -> tuple[list[Figure], list[str]]:
    """Return maps of the channels that have slip terms, and sentences about the others."""
    if not model.motion.slip_size:
        return [], ["The model has no slip terms, so there are no maps of slip."]
    speed, yaw_rate = model.content.range.speed, model.content.range.yaw_rate
    if speed[1] - speed[0] < 1e-6 or yaw_rate[1] - yaw_rate[0] < 1e-6:
        return [], ["The log holds one speed or one yaw rate only, so slip cannot be drawn over both."]
    grid, basis = _grid(model), model.motion.basis
    terms = (basis.lon, basis.lat, basis.ang)
    drawn = [channel for channel in range(len(CHANNELS)) if terms[channel]]
    names = [name for (name, _, _), given in zip(CHANNELS, terms, strict=True) if not given]
    return (
        [contour_map(grid, channel) for channel in drawn],
        [f"The model has no terms for {name} slip." for name in names],
    )


def _grid(model: Model) -> SlipGrid:
    basis, size = model.motion.basis, model.motion.slip_size
    alpha = np.ascontiguousarray(model.mean[:size])
    covariance = np.asfortranarray(model.covariance[:size, :size])
    span = model.content.range
    speed = np.linspace(span.speed[0], span.speed[1], NODES)
    yaw_rate = np.linspace(span.yaw_rate[0], span.yaw_rate[1], NODES)
    mean = np.empty((3, NODES, NODES))
    std = np.empty((3, NODES, NODES))
    for row, omega in enumerate(yaw_rate.tolist()):
        for column, v in enumerate(speed.tolist()):
            state = _core.SlipState(v, omega, 0.0, 0.0)
            mean[:, row, column] = _core.slip_rate(basis, alpha, state)
            variance = np.diag(_core.slip_rate_covariance(basis, covariance, state))
            std[:, row, column] = np.sqrt(np.maximum(variance, 0.0))
    return SlipGrid(speed, yaw_rate, mean, std)
