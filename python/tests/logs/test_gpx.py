# SPDX-License-Identifier: Apache-2.0
"""Points of GPX tracks become positions, and files that would harm or are cut off do not."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.gpx import is_gpx, read_gpx
from slipwise.logs.left_out import Tally
from slipwise.logs.pose_file import PoseFile, read_pose_file

HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">\n'
)
FOOT = "</trkseg></trk></gpx>\n"
NOON = 1714564800.0  # 2024-05-01 12:00:00 UTC


def point(second: float, north: float, ele: str = "<ele>300.0</ele>") -> str:
    time = f"<time>2024-05-01T12:00:{second:06.3f}Z</time>"
    return f'<trkpt lat="{48.0 + north / 111200.0:.9f}" lon="9.0">{ele}{time}</trkpt>\n'


def track(*points: str) -> str:
    return HEAD + '<wpt lat="1" lon="1"/><trk><name>a</name><trkseg>' + "".join(points) + FOOT


def read(folder: Path, content: str, tally: Tally | None = None) -> PoseFile:
    (folder / "a.gpx").write_text(content)
    return read_pose_file(folder / "a.gpx", {}, tally or Tally())


def test_points_are_metres_in_the_plane_at_the_first(tmp_path: Path) -> None:
    found = read(tmp_path, track(point(0.0, 0.0), point(0.5, 1.0), point(1.0, 2.0)))
    assert (found.format, found.has_heading) == ("gpx", False)
    np.testing.assert_allclose(found.stream.t, NOON + np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(found.stream.columns["y"], [0.0, 1.0, 2.0], atol=2e-3)
    np.testing.assert_allclose(found.stream.columns["x"], 0.0, atol=1e-6)


def test_a_height_that_is_missing_is_not_known_and_moves_nothing(tmp_path: Path) -> None:
    stream = read(tmp_path, track(point(0.0, 0.0), point(0.5, 1.0, ""), point(1.0, 2.0))).stream
    assert np.isnan(stream.columns["z"]).tolist() == [False, True, False]
    np.testing.assert_allclose(stream.columns["y"], [0.0, 1.0, 2.0], atol=2e-3)


def test_points_without_a_time_or_with_impossible_numbers_are_counted(tmp_path: Path) -> None:
    tally = Tally()
    bad = [
        '<trkpt lat="48" lon="9"/>',
        '<trkpt lat="nan" lon="9"><time>2024-05-01T12:00:03Z</time></trkpt>',
        '<trkpt lat="1e308" lon="9"><time>2024-05-01T12:00:04Z</time></trkpt>',
        '<trkpt lat="48" lon="9"><time>99999-05-01T12:00:04Z</time></trkpt>',
        '<trkpt lat="48" lon="9"><ele>1e300</ele><time>2024-05-01T12:00:05Z</time></trkpt>',
    ]
    assert len(read(tmp_path, track(point(0.0, 0.0), *bad, point(9.0, 1.0)), tally).stream.t) == 2
    (left_out,) = tally.result()
    assert (left_out.kind, left_out.count, left_out.where) == ("poor-fix", 5, "a.gpx, track point 2")


def test_a_first_fix_on_another_continent_is_left_out(tmp_path: Path) -> None:
    tally = Tally()
    lost = '<trkpt lat="0" lon="0"><time>2024-05-01T11:59:59Z</time></trkpt>'
    stream = read(tmp_path, track(lost, *(point(k, k) for k in range(5))), tally).stream
    np.testing.assert_allclose(stream.columns["y"], np.arange(5.0), atol=2e-3)
    assert [entry.reason for entry in tally.result()] == [
        "fixes further than 100 km from the middle of the track"
    ]


@pytest.mark.parametrize("kept", [2, 3])
def test_of_a_file_that_is_cut_off_the_points_before_the_cut_are_read(tmp_path: Path, kept: int) -> None:
    whole = track(*(point(k, k) for k in range(10)))
    at = [k for k in range(len(whole)) if whole.startswith("<trkpt", k)][kept] + 20
    tally = Tally()
    assert len(read(tmp_path, whole[:at], tally).stream.t) == kept
    (entry,) = tally.result()
    assert (entry.kind, entry.count) == ("broken-row", 1)


def test_every_cut_is_read_or_refused(tmp_path: Path) -> None:
    whole = track(point(0.0, 0.0), point(1.0, 1.0))
    for at in range(0, len(whole), 7):
        with contextlib.suppress(LogError):
            assert len(read(tmp_path, whole[:at]).stream.t) <= 2


BOMB = "".join(f'<!ENTITY a{k} "{10 * f"&a{k - 1};"}">' for k in range(1, 10))


@pytest.mark.parametrize(
    "declared",
    [
        f'<!DOCTYPE gpx [<!ENTITY a0 "ha">{BOMB}]>',
        '<!DOCTYPE gpx [<!ENTITY a9 SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE gpx SYSTEM "http://127.0.0.1/gpx.dtd">',
    ],
)
def test_files_that_declare_entities_are_refused_before_any_is_expanded(
    tmp_path: Path, declared: str
) -> None:
    content = track("<name>&a9;</name>", point(0.0, 0.0)).replace("?>\n", f"?>\n{declared}\n", 1)
    with pytest.raises(LogError, match=r"declares a document type .*take the declaration out"):
        read(tmp_path, content)


def test_entities_that_nobody_declared_end_the_file(tmp_path: Path) -> None:
    tally = Tally()
    stream = read(tmp_path, track(point(0.0, 0.0), "<name>&a9;</name>", point(1.0, 1.0)), tally).stream
    assert (len(stream.t), tally.result()[0].kind) == (1, "broken-row")


def test_elements_in_each_other_without_end_are_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="more than 100 elements in each other"):
        read(tmp_path, HEAD + 100_000 * "<a>")


def test_other_texts_are_no_gpx() -> None:
    assert is_gpx("\n" + HEAD)
    assert not is_gpx("t,x,y\n# <gpx\n")
    stream, notes = read_gpx(Path("a.gpx"), HEAD + "</gpx>", Tally())
    assert (len(stream.t), notes) == (0, ())
