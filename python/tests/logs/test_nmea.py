# SPDX-License-Identifier: Apache-2.0
"""Sentences of a receiver become positions with a date; what is damaged or not measured is counted."""

from __future__ import annotations

import contextlib
from functools import reduce
from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.nmea import is_nmea
from slipwise.logs.pose_file import PoseFile, read_pose_file

NOON = 1714564800.0  # 2024-05-01 12:00:00 UTC
RMC = "GNRMC,{clock},A,4800.00000,N,00900.00000,E,0.5,0.0,{date},,,A"


def sentence(body: str) -> str:
    return f"${body}*{reduce(lambda a, b: a ^ ord(b), body, 0):02X}\r\n"


def gga(clock: str, north: float = 0.0, quality: int = 4, height: str = "300.0,M,48.0") -> str:
    return sentence(f"GPGGA,{clock},48{north / 1853.3:08.5f},N,00900.00000,E,{quality},12,0.6,{height},M,,")


def rmc(clock: str, date: str = "010524") -> str:
    return sentence(RMC.format(clock=clock, date=date))


def read(folder: Path, content: str, tally: Tally | None = None) -> PoseFile:
    (folder / "a.nmea").write_text(content)
    return read_pose_file(folder / "a.nmea", {}, tally or Tally())


def test_fixes_are_metres_dated_by_the_first_date_even_before_it(tmp_path: Path) -> None:
    content = gga("120000.00") + rmc("120000.00") + gga("120000.50", 1.0, 5) + gga("120001.00", 2.0)
    found = read(tmp_path, sentence("GPTXT,01,01,02,u-blox") + content)
    assert (found.format, found.has_heading) == ("nmea", False)
    np.testing.assert_allclose(found.stream.t, NOON + np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(found.stream.columns["y"], [0.0, 1.0, 2.0], atol=0.02)
    assert found.notes == ("fixes of a.nmea: 2 RTK fixed, 1 RTK float",)


def test_south_and_west_are_negative(tmp_path: Path) -> None:
    there = gga("120000.00") + gga("120001.00", 10.0)
    bodies = [
        line[1:-5].replace(",N,", ",S,").replace(",E,", ",W,") for line in there.splitlines(keepends=True)
    ]
    stream = read(tmp_path, rmc("120000.00") + "".join(map(sentence, bodies))).stream
    assert stream.columns["y"][1] < -9.0


def test_midnight_starts_the_next_day_before_the_date_is_said(tmp_path: Path) -> None:
    clocks = (
        gga("235959.50") + rmc("235959.50") + gga("000000.00") + rmc("000000.00", "020524") + gga("000000.50")
    )
    stream = read(tmp_path, clocks).stream
    np.testing.assert_allclose(np.diff(stream.t), 0.5)


def test_without_a_date_the_clock_is_said_to_be_that_of_the_day(tmp_path: Path) -> None:
    found = read(tmp_path, gga("235959.00") + gga("000000.00"))
    assert found.stream.t.tolist() == [86399.0, 86400.0]
    assert "seconds of the day; give --pose-clock-offset auto" in found.notes[0]


def test_rmc_serve_where_there_are_no_gga_and_have_no_height(tmp_path: Path) -> None:
    void = sentence(RMC.format(clock="115959.00", date="010524").replace(",A,4", ",V,4"))
    tally = Tally()
    stream = read(tmp_path, void + rmc("120000.00") + rmc("120001.00"), tally).stream
    np.testing.assert_allclose(stream.t, NOON + np.array([0.0, 1.0]))
    assert np.isnan(stream.columns["z"]).all()
    assert [(e.kind, e.count, e.where) for e in tally.result()] == [("poor-fix", 1, "a.nmea, line 1")]


def test_wrong_checksums_cut_sentences_and_fixes_that_were_not_measured_are_counted(tmp_path: Path) -> None:
    wrong = gga("120001.00").replace("300.0", "301.0")
    cut = gga("120002.00")[:-5] + "\n"
    swallowed = gga("120003.00")[:20] + gga("120003.00")
    estimated, none = gga("120004.00", quality=6), gga("120005.00", quality=0)
    tally = Tally()
    content = rmc("120000.00") + gga("120000.00") + wrong + cut + swallowed + estimated + none
    assert len(read(tmp_path, content, tally).stream.t) == 1
    left_out = {entry.reason: (entry.count, entry.where) for entry in tally.result()}
    assert left_out == {
        "sentences that are cut off": (2, "a.nmea, line 4"),
        "sentences with a wrong checksum": (1, "a.nmea, line 3"),
        "fixes without a time or a place": (2, "a.nmea, line 6"),
    }


def test_impossible_fields_are_counted(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for body in [
        "GPGGA,999999.00,4800.0,N,00900.0,E,4,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,-10000.00,4800.0,N,00900.0,E,4,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,120001.00,9999.0,N,00900.0,E,4,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,120001.00,1e308,N,00900.0,E,4,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,120001.00,4800.0,Q,00900.0,E,4,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,120001.00,4800.0,N,00900.0,E,4,12,0.6,1e308,M,1e308,M,,",
        "GPGGA,120001.00,4800.0,N,00900.0,E,99999999999999999999,12,0.6,300.0,M,48.0,M,,",
        "GPGGA,120001.00",
        "GPGGA,",
    ]:
        with subtests.test(body=body):
            tally = Tally()
            content = rmc("120000.00") + gga("120000.00") + sentence(body)
            assert len(read(tmp_path, content, tally).stream.t) == 1
            assert [(entry.kind, entry.count) for entry in tally.result()] == [("poor-fix", 1)]


def test_dates_that_jump_cost_no_more_than_their_lines(tmp_path: Path) -> None:
    jumps = "".join(
        rmc("120000.00", date) + gga("120000.00") for date in 200 * ["311268", "010169", "990099"]
    )
    assert len(read(tmp_path, jumps).stream.t) == 600


def test_every_cut_is_read_or_refused(tmp_path: Path) -> None:
    whole = rmc("120000.00") + gga("120000.00") + gga("120001.00", 1.0)
    for at in range(0, len(whole), 3):
        with contextlib.suppress(LogError):
            assert len(read(tmp_path, whole[:at]).stream.t) <= 2


def test_other_texts_are_no_sentences() -> None:
    assert is_nmea("\n$PUBX,00\n$GNVTG,,T*22\n")
    assert not is_nmea("t,x,y\n$5,2,3\n")
