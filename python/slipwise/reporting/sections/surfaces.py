# SPDX-License-Identifier: Apache-2.0
"""The learned slip over speed and yaw rate, as surfaces and as maps."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.models.model import Model
from slipwise.reporting.contents import Contents
from slipwise.reporting.markup import legend, missing, paragraph
from slipwise.reporting.slip_figures import CHANNELS, NODES, SlipGrid, contour_map, turnable_surface


class SurfacesSection:
    """What slip did the model learn?"""

    title = "Learned slip"
    explanation = (
        "The slip rates that the model adds to the commanded motion on level ground, within the speeds and "
        "yaw rates of the log; red takes away, blue adds, and the grey sheets lie one standard deviation "
        "above and below."
    )

    def html(self, contents: Contents) -> str:
        """Return a surface to be turned and a contour map for each channel of slip."""
        model = contents.calibration.model
        if not model.motion.slip_size:
            return missing("The model has no slip terms, so there are no slip surfaces.")
        speed, yaw_rate = model.content.range.speed, model.content.range.yaw_rate
        if speed[1] - speed[0] < 1e-6 or yaw_rate[1] - yaw_rate[0] < 1e-6:
            return missing("The log holds one speed or one yaw rate only, so slip cannot be drawn over both.")
        grid = _grid(model)
        basis = model.motion.basis
        terms = (basis.lon, basis.lat, basis.ang)
        drawn = [channel for channel in range(len(CHANNELS)) if terms[channel]]
        surfaces = "".join(turnable_surface(grid, channel).html() for channel in drawn)
        maps = "".join(contour_map(grid, channel).html() for channel in drawn)
        names = [name for (name, _, _), given in zip(CHANNELS, terms, strict=True) if not given]
        absent = (missing(f"The model has no terms for {name} slip.") for name in names)
        keys = (("± 1 sigma", "#7b8794", "area"),)
        return (
            paragraph("Drag to turn a surface, pinch or use the wheel to zoom.", kind="explanation")
            + legend(keys)
            + f'<div class="grid">{surfaces}</div><div class="grid">{maps}</div>'
            + "".join(absent)
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
