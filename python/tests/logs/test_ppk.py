# SPDX-License-Identifier: Apache-2.0
"""Solutions of RTKLIB become positions in metres, stamped in UTC."""

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.log import empty_poses
from slipwise.logs.ppk import is_ppk, read_ppk

HEADER = """% program   : RTKPOST ver.2.4.3
% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)
"""
ROWS = """2023/05/03 10:00:00.000   48.000000000    9.000000000   300.0000   1  10   0.0060   0.0080   0.0200
2023/05/03 10:00:00.200   48.000001800    9.000000000   300.0000   2  10   0.0060   0.0080   0.0200
2023/05/03 10:00:00.400   48.000003600    9.000000000   300.0000   5  10   3.0060   3.0080   3.0200
"""
PATH = Path("a.pos")
TEN_O_CLOCK = 1683108000.0  # 2023-05-03 10:00:00 UTC


def test_positions_are_metres_and_gps_time_becomes_utc() -> None:
    tally = Tally()
    assert is_ppk(HEADER + ROWS)
    stream, notes = read_ppk(PATH, HEADER + ROWS, tally)
    np.testing.assert_allclose(stream.t, TEN_O_CLOCK - 18.0 + np.array([0.0, 0.2]))
    np.testing.assert_allclose(stream.columns["y"], [0.0, 0.2002], atol=1e-3)
    np.testing.assert_allclose(stream.columns["std_xy"], 0.00707, atol=1e-4)
    assert "18 s ahead of UTC" in notes[0]
    (poor,) = tally.result()
    assert (poor.kind, poor.count, poor.where) == ("poor-fix", 1, "a.pos, line 6")


def test_utc_stays_and_weeks_are_understood() -> None:
    stream, notes = read_ppk(PATH, HEADER.replace("GPST", "UTC ") + ROWS, Tally())
    assert (stream.t[0], notes) == (TEN_O_CLOCK, ())
    week = ROWS.replace("2023/05/03 10:00:00", "2260 295200")  # Wednesday, 82 h into the week
    np.testing.assert_allclose(read_ppk(PATH, HEADER + week, Tally())[0].t[0], TEN_O_CLOCK - 18.0)


def test_broken_lines_are_counted_and_other_coordinates_refused() -> None:
    tally = Tally()
    stream, _ = read_ppk(PATH, HEADER + ROWS + "2023/05/03 10:00:01.000 148.0 9.0 300\nnonsense\n", tally)
    assert len(stream.t) == 2
    assert {entry.kind: entry.count for entry in tally.result()} == {"poor-fix": 1, "broken-row": 2}
    with pytest.raises(LogError, match=r"not solutions in degrees .*lat/lon/height"):
        read_ppk(PATH, HEADER.replace("latitude(deg)", "x-ecef(m)") + ROWS, Tally())


def test_a_file_without_a_usable_solution_is_empty() -> None:
    stream, _ = read_ppk(PATH, HEADER + ROWS.splitlines()[2], Tally())
    assert len(stream.t) == len(empty_poses())
