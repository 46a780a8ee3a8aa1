# SPDX-License-Identifier: Apache-2.0
"""Fixes become positions in one plane, whatever the first and the heights are."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.logs.left_out import Tally
from slipwise.logs.satellite_track import Fix, track_stream

PATH = Path("a.gpx")
NAN = float("nan")


def fixes(count: int, longitude: float = 9.0) -> list[tuple[int, Fix | None]]:
    return [(k + 1, (float(k), 48.0, longitude + 1e-5 * k, 300.0)) for k in range(count)]


def test_a_track_over_the_date_line_is_one_piece() -> None:
    stream = track_stream(
        PATH, "line", [(1, (0.0, 0.0, 179.99999, NAN)), (2, (1.0, 0.0, -179.99999, NAN))], Tally()
    )
    np.testing.assert_allclose(stream.columns["x"], [0.0, 2.226], atol=1e-3)
    assert np.isnan(stream.columns["z"]).all()


def test_far_fixes_do_not_tilt_the_plane_of_the_others() -> None:
    tally = Tally()
    stream = track_stream(PATH, "line", [(9, (0.0, -48.0, 9.0, 0.0)), *fixes(5)], tally)
    np.testing.assert_allclose(stream.columns["z"], 0.0, atol=1e-3)
    assert stream.rows.tolist() == [1, 2, 3, 4, 5]
    assert tally.result()[0].where == "a.gpx, line 9"


def test_no_fix_is_an_empty_stream() -> None:
    tally = Tally()
    stream = track_stream(PATH, "line", [(1, None), (2, (NAN, 0.0, 0.0, 0.0))], tally)
    assert len(stream.t) == len(stream.columns["x"]) == 0
    assert tally.result()[0].count == 2
