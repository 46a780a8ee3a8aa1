# SPDX-License-Identifier: Apache-2.0
"""Pictures of slip surfaces show the surface, its spread and the examples."""

import numpy as np
from python.tests.surfaces.known_surface import BASIS, draw

from slipwise.reporting.slip_figures import surface_figures, surface_grid
from slipwise.surfaces import BayesianSurface


def test_a_surface_is_drawn_between_its_sheets_with_its_examples() -> None:
    examples = draw(60, 1)
    surface = BayesianSurface(BASIS)
    surface.fit(examples)
    grid, figures = surface_grid(surface, examples), surface_figures(surface, examples)
    at = surface.predict(grid.speed[3], grid.yaw_rate[7])
    np.testing.assert_allclose(grid.mean[:, 7, 3], at.mean[0])
    np.testing.assert_allclose(grid.std[:, 7, 3], at.std[0])
    assert [figure.key for figure in figures] == ["surface-forward", "surface-sideways", "surface-angular"]
    kinds = [trace["type"] for trace in figures[0].traces]
    assert kinds == ["surface", "surface", "surface", "scatter3d"]
    assert len(figures[0].traces[3]["z"]) == 60
    assert "surface-forward" in figures[0].html()
