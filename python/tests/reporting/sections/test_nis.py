# SPDX-License-Identifier: Apache-2.0
"""The section of the reported uncertainty."""

from __future__ import annotations

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import make_results

from slipwise.calibration.statistics import nis_band
from slipwise.reporting.sections.nis import NisSection
from slipwise.student import fraction_inside


def test_predictions_and_learning_windows_are_shown_with_both_bands() -> None:
    results = make_results()
    figures = figures_of(NisSection().html(contents_of(results)))
    assert list(figures) == ["figure-nis-predictions", "figure-nis-learning"]
    history = results.calibration.history
    assert history is not None
    learning = figures["figure-nis-learning"]
    assert np.allclose(learning["data"][0]["y"], history.nis, rtol=1e-5)
    window, mean = learning["layout"]["shapes"][:2]
    assert np.allclose([window["y0"], window["y1"]], [0.2158, 9.3484], atol=1e-4)
    assert np.allclose([mean["y0"], mean["y1"]], nis_band(20), rtol=1e-5)


def test_band_of_predictions_is_that_of_their_t() -> None:
    contents = contents_of(make_results())
    figure = figures_of(NisSection().html(contents))["figure-nis-predictions"]
    window = figure["layout"]["shapes"][0]
    assert np.allclose(fraction_inside([window["y0"], window["y1"]], 5.0), [0.025, 0.975], atol=1e-4)


def test_moving_mean_is_that_of_the_last_twenty() -> None:
    results = make_results()
    history = results.calibration.history
    assert history is not None
    line = figures_of(NisSection().html(contents_of(results)))["figure-nis-learning"]["data"][1]
    assert np.isclose(line["y"][0], history.nis[:20].mean(), rtol=1e-5)
    assert np.isclose(line["y"][-1], history.nis[-20:].mean(), rtol=1e-5)
