# SPDX-License-Identifier: Apache-2.0
"""A predicted path as a Plotly figure: where the robot will be, and how sure that is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise.ellipse import ellipse

if TYPE_CHECKING:
    import plotly.graph_objects as go

Floats = NDArray[np.float64]

MOST_ELLIPSES = 6  # evenly in time, the last at the end
SENDING_BUTTONS = ("sendChartToCloud", "sendDataToCloud")  # of Plotly; no button of a figure uploads a path


def path_figure(poses: Floats, covariance: Floats, dof: Floats) -> go.Figure:
    """Return a figure of the path seen from above, with 95 % ellipses of the position.

    Args:
        poses: [N, 3] x, y [m], yaw [rad].
        covariance: [N, 3, 3] of the poses.
        dof: [N] degrees of freedom of their Student t.
    """
    import plotly.graph_objects as go

    figure = go.Figure(
        go.Scatter(x=poses[:, 0], y=poses[:, 1], mode="lines", name="predicted", line={"width": 3})
    )
    count = min(MOST_ELLIPSES, len(poses) - 1)
    places = np.unique(np.linspace(0, len(poses) - 1, count + 1).round().astype(int)[1:])
    for place in places.tolist():
        outline = ellipse(poses[place, :2], covariance[place, :2, :2], float(dof[place]))
        if outline is not None:
            figure.add_scatter(
                x=outline[:, 0],
                y=outline[:, 1],
                mode="lines",
                name="95 % ellipse",
                legendgroup="ellipse",
                showlegend=bool(place == places[0]),
                line={"width": 1, "color": "grey"},
            )
    figure.update_layout(
        xaxis_title="x [m]",
        yaxis_title="y [m]",
        template="plotly_white",
        modebar={"remove": list(SENDING_BUTTONS)},
    )
    figure.update_yaxes(scaleanchor="x")
    return figure
