# SPDX-License-Identifier: Apache-2.0
"""The strip of surfaces along time."""

from __future__ import annotations

import numpy as np
from reporting.page_parts import figures_of

from slipwise.reporting.ground_strip import UNNAMED, GroundMark, GroundStrip, strip_html
from slipwise.reporting.palette import ALARM_COLOUR, BAND


def strip() -> GroundStrip:
    probability = np.array([[1.0, 0.0], [0.4, 0.6], [0.0, 1.0]])
    marks = (GroundMark(2.0, "<b>mud</b> recalled"),)
    return GroundStrip(np.array([1.0, 2.0, 3.0]), ("mud", UNNAMED), probability, (1.5,), marks, (2.5,))


def test_probabilities_are_stacked_and_what_has_no_name_is_grey() -> None:
    mud, other, _ = figures_of(strip_html(strip(), title="time [s]"))["figure-ground"]["data"]
    assert mud["stackgroup"] == other["stackgroup"]
    assert np.allclose(np.add(mud["y"], other["y"]), 1.0)
    assert other["line"]["color"] == BAND


def test_alarms_are_lines_and_decisions_are_marks_with_escaped_words() -> None:
    figure = figures_of(strip_html(strip(), title="time [s]"))["figure-ground"]
    assert figure["data"][-1]["text"] == ["&lt;b&gt;mud&lt;/b&gt; recalled"]
    lines = {shape["x0"]: shape["line"]["color"] for shape in figure["layout"]["shapes"]}
    assert lines[1.5] == ALARM_COLOUR
    assert 2.5 in lines
