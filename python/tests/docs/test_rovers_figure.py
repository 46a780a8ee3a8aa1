# SPDX-License-Identifier: Apache-2.0
"""The figure of docs/vehicles.md shows each parameter of each drive with its deviation and its truth."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.rover_recovery import CASES, Recovery
from docs.figures.make_rovers import SHOWN, draw_recovery

from slipwise import _core


def test_every_parameter_is_drawn_beside_its_truth() -> None:
    matplotlib = pytest.importorskip("matplotlib.figure")
    axes = matplotlib.Figure().subplots()
    size = _core.named_basis(CASES[0].basis).size
    values = -0.01 * np.arange(size)
    drives = [Recovery(values, np.full(size, 0.01), values + 0.001, np.zeros(1), 1.0) for _ in range(3)]
    draw_recovery(axes, CASES[0], drives)
    assert [label.get_text() for label in axes.get_xticklabels()][:2] == ["lon.V", "lon.Vy"]
    crosses = [line for line in axes.lines if line.get_marker() == "x"]
    assert len(crosses) == 3
    np.testing.assert_allclose(crosses[0].get_ydata(), values + 0.001)
    assert len(axes.containers) == 3
    assert set(SHOWN) <= set(CASES)
