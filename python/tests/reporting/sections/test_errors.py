# SPDX-License-Identifier: Apache-2.0
"""The section of the errors over time."""

from __future__ import annotations

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import make_results

from slipwise.reporting.sections.errors import ErrorsSection


def test_plain_simple_and_learned_errors_are_drawn_over_time() -> None:
    contents = contents_of(make_results())
    figures = figures_of(ErrorsSection().html(contents))
    assert list(figures) == ["figure-error-position", "figure-error-heading"]
    assert [trace["name"] for trace in figures["figure-error-heading"]["data"]] == [
        "kinematic baseline",
        "edd-2",
        "slipwise",
    ]
    auto = contents.predictions("auto", 5.0)
    assert auto is not None
    shown = figures["figure-error-heading"]["data"][2]["y"]
    assert np.allclose(shown, np.degrees(auto.heading_error), rtol=1e-5)
