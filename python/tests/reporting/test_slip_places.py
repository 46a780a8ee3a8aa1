# SPDX-License-Identifier: Apache-2.0
"""Slip that belongs to a place is found there, with how sure it is."""

from __future__ import annotations

import numpy as np
import pytest
from reporting.drives_in_circles import FIRM, SLIPPERY, circling

from slipwise.reporting.slip_places import slip_places


def test_cells_have_the_slip_of_their_ground_within_three_sigma() -> None:
    log, part = circling()
    places = slip_places(log.runs[0].poses, part, 0, "forward")
    assert places is not None
    sure = np.abs(places.x) > 1.5  # both grounds lie in the cells between
    expected = 100.0 * np.where(places.x < 0.0, SLIPPERY, FIRM)
    assert (np.abs(places.percent - expected)[sure] < 3.0 * places.std[sure] + 0.2).all()
    assert (places.passes > 1).sum() > 20


def test_passes_agree_where_slip_is_the_place_s_own() -> None:
    log, part = circling()
    forward, yaw = (slip_places(log.runs[0].poses, part, 0, c) for c in ("forward", "yaw"))
    assert forward is not None
    assert yaw is not None
    assert forward.agreement == pytest.approx(1.0, abs=0.1)
    assert yaw.agreement is not None
    assert abs(yaw.agreement) < 0.6  # noise alone


def test_one_pass_tells_nothing_of_agreement_and_no_window_no_cell() -> None:
    log, part = circling(laps=1)
    once = slip_places(log.runs[0].poses, part, 0, "forward")
    assert once is None or once.agreement is None
    assert slip_places(log.runs[0].poses, part, 1, "forward") is None
