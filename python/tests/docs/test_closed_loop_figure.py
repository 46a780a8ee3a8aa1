# SPDX-License-Identifier: Apache-2.0
"""The figure of docs/results.md shows a course, its floors and how the variants drove."""

from __future__ import annotations

import numpy as np
import pytest
from docs.figures.make_closed_loop import LONGEST, SHADES, SHOWN, draw_errors, draw_paths

from slipwise_sim.demo.closed_loop import VARIANTS, Driven
from slipwise_sim.demo.slalom_course import FLOORS, slalom_course
from slipwise_sim.demo.slalom_drive import Trace

COURSE = slalom_course(1)


def beside(left: float) -> Driven:
    """Return a drive along the course, some metres [m] to the left of it."""
    t = np.arange(1, len(COURSE.points) + 1) / 10.0
    floor = np.array([COURSE.floor_at(x) for x in COURSE.points[:, 0]])
    return Driven(Trace(t, COURSE.points + np.array((0.0, left)), np.full(len(t), left), floor), True)


def test_every_floor_is_shaded_and_every_variant_drawn() -> None:
    matplotlib = pytest.importorskip("matplotlib.figure")
    driven = {name: beside(0.1 * (place + 1)) for place, name in enumerate(SHOWN)}
    above, below = matplotlib.Figure().subplots(2, 1)
    draw_paths(above, COURSE, driven)
    draw_errors(below, driven)
    assert [text.get_text() for text in above.texts] == [floor.name for floor in FLOORS] == list(SHADES)
    assert {line.get_label() for line in above.lines} == {"reference", *SHOWN}
    curves = [line for line in below.lines if line.get_linestyle() == "-"]
    assert [curve.get_ydata()[-1] for curve in curves] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert max(curve.get_xdata()[-1] for curve in curves) <= LONGEST
    assert set(SHOWN) <= set(VARIANTS)
