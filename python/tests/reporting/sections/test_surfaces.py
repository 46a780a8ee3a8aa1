# SPDX-License-Identifier: Apache-2.0
"""The section of the slip surfaces."""

from __future__ import annotations

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import make_results

from slipwise.reporting.sections.surfaces import SurfacesSection


def test_maps_show_the_slip_with_its_sigma_over_the_range_of_the_model() -> None:
    figures = figures_of(SurfacesSection().html(contents_of(make_results())))
    yaw = figures["figure-contours-angular"]["data"][0]
    yaw_rate = np.array(yaw["y"])
    assert np.allclose(yaw["z"], -0.348 * yaw_rate[:, None], atol=1e-5)
    assert np.allclose(yaw["customdata"], 0.01 * np.abs(yaw_rate)[:, None], atol=1e-5)
    forward = figures["figure-contours-forward"]["data"][0]
    assert (forward["x"][0], forward["x"][-1]) == (0.2, 1.8)
    assert (forward["y"][0], forward["y"][-1]) == (-0.7, 0.7)
