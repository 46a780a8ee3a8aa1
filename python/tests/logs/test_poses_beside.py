# SPDX-License-Identifier: Apache-2.0
"""Poses of a file go into a bag or a table that has none, on the log's clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_bags import EPOCH, SECOND, TWIST, Bag
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.errors import LogError, SettingsError
from slipwise.logs import LogOptions, Run, open_log

DRIVE = Drive(basis=_core.named_basis("edd-2"), alpha=(-0.05, -0.3), lag=0.3, delay=0.1)


@pytest.fixture(scope="module")
def run() -> Run:
    return simulated_run(DRIVE)


def table(path: Path, run: Run) -> Path:
    """Inputs alone, under names of their own."""
    assert run.wheels is not None
    rows = [f"{t},{v},{w}" for t, v, w in zip(run.wheels.t, run.wheels.v, run.wheels.omega, strict=True)]
    path.write_text("\n".join(["stamp,odo_v,turn", *rows, ""]))
    return path


def tum(path: Path, run: Run, *, away: float = 0.0) -> Path:
    p = run.poses
    half = 0.5 * p.yaw
    lines = [
        f"{t - away:.6f} {x:.6f} {y:.6f} 0 0 0 {s:.9f} {c:.9f}"
        for t, x, y, s, c in zip(p.t, p.x, p.y, np.sin(half), np.cos(half), strict=True)
    ]
    path.write_text("\n".join([*lines, ""]))
    return path


def options(poses: Path, offset: float | str | None = None) -> LogOptions:
    return LogOptions(poses=poses, pose_clock_offset=offset, columns={"t": "stamp", "odo_omega": "turn"})


def test_poses_of_a_file_are_those_of_the_log(tmp_path: Path, run: Run) -> None:
    log = open_log(table(tmp_path / "a.csv", run), options=options(tum(tmp_path / "p.txt", run)))
    poses = log.runs[0].poses
    np.testing.assert_allclose(poses.x, run.poses.x, atol=1e-6)
    np.testing.assert_allclose(np.unwrap(poses.yaw), np.unwrap(run.poses.yaw), atol=1e-6)
    assert f"poses are those of p.txt (tum): {len(poses)} of {len(poses)} lie in the log" in log.notes
    assert [source.format for source in log.sources] == ["csv", "tum"]


def test_an_offset_is_added_or_found(tmp_path: Path, run: Run) -> None:
    log, poses = table(tmp_path / "a.csv", run), tum(tmp_path / "p.txt", run, away=500.25)
    given = open_log(log, options=options(poses, 500.25))
    np.testing.assert_allclose(given.runs[0].poses.t, run.poses.t, atol=1e-5)
    found = open_log(log, options=options(poses, "auto"))
    np.testing.assert_allclose(found.runs[0].poses.t, run.poses.t, atol=0.05)
    assert any("s are added to the stamps of p.txt" in note and "next best" in note for note in found.notes)


def test_clocks_that_do_not_meet_are_refused_with_the_option(tmp_path: Path, run: Run) -> None:
    log, poses = table(tmp_path / "a.csv", run), tum(tmp_path / "p.txt", run, away=1e6)
    with pytest.raises(LogError, match=r"no pose lies within the log.*p\.txt.*--pose-clock-offset auto"):
        open_log(log, options=options(poses))


def test_clocks_that_seem_to_meet_and_do_not_are_pointed_out(tmp_path: Path, run: Run) -> None:
    log, poses = table(tmp_path / "a.csv", run), tum(tmp_path / "p.txt", run, away=60.0)
    apart = open_log(log, options=options(poses))
    assert any("hardly agrees with the inputs" in note for note in apart.notes)
    together = open_log(log, options=options(poses, 60.0))
    assert not any("hardly agrees" in note for note in together.notes)


def test_a_bag_without_any_pose_takes_those_of_the_file(tmp_path: Path, run: Run) -> None:
    bag = Bag()
    assert run.commands is not None
    for t, v, omega in zip(run.commands.t, run.commands.v, run.commands.omega, strict=True):
        bag.add(EPOCH + round(float(t) * SECOND), "/cmd_vel", TWIST, bag.twist(float(v), float(omega)))
    poses = tum(tmp_path / "p.txt", run, away=-EPOCH / SECOND)
    log = open_log(bag.write(tmp_path / "a.mcap"), options=LogOptions(poses=poses))
    assert len(log.runs[0].poses) == len(run.poses)
    auto = LogOptions(poses=tum(tmp_path / "q.txt", run), pose_clock_offset="auto")
    notes = open_log(tmp_path / "a", options=auto).notes
    assert any("the delay of the drive is a part of that offset" in note for note in notes)


def test_positions_of_ppk_get_their_heading_from_the_track(tmp_path: Path, run: Run) -> None:
    lines = ["%  UTC  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)"]
    for t, x, y in zip(run.poses.t[::4], run.poses.x[::4], run.poses.y[::4], strict=True):
        stamp = f"1970/01/01 00:{int(t // 60):02d}:{t % 60:06.3f}"
        lines.append(f"{stamp} {48.0 + y / 111_000:.9f} {9.0 + x / 74_600:.9f} 300 1 9 0.01 0.01")
    (tmp_path / "a.pos").write_text("\n".join([*lines, ""]))
    log = open_log(table(tmp_path / "a.csv", run), options=options(tmp_path / "a.pos"))
    poses = log.runs[0].poses
    assert len(poses) > 0.5 * len(run.poses.t[::4])
    truth = np.interp(poses.t, run.poses.t, np.unwrap(run.poses.yaw))
    apart = np.angle(np.exp(1j * (poses.yaw - truth)))
    assert np.median(np.abs(apart)) < 0.2
    assert poses.course


def test_a_gpx_track_gives_positions_that_are_learned_from(tmp_path: Path, run: Run) -> None:
    points = [
        f'<trkpt lat="{48.0 + y / 111_200:.9f}" lon="{9.0 + x / 74_600:.9f}">'
        f"<time>1970-01-01T00:{int(t // 60):02d}:{t % 60:06.3f}Z</time></trkpt>"
        for t, x, y in zip(run.poses.t[::4], run.poses.x[::4], run.poses.y[::4], strict=True)
    ]
    (tmp_path / "a.gpx").write_text(f"<gpx><trk><trkseg>{''.join(points)}</trkseg></trk></gpx>")
    log = open_log(table(tmp_path / "a.csv", run), options=options(tmp_path / "a.gpx"))
    assert log.runs[0].poses.course
    assert log.sources[1].format == "gpx"
    assert any(note.startswith("poses are those of a.gpx (gpx)") for note in log.notes)


def test_inputs_that_are_all_faulty_are_named(tmp_path: Path, run: Run) -> None:
    (tmp_path / "a.csv").write_text("stamp,odo_v,turn\n0,nan,1\n1,nan,1\n")
    poses = tum(tmp_path / "p.txt", run)
    with pytest.raises(LogError, match=r"the log has no usable inputs .*a\.csv"):
        open_log(tmp_path / "a.csv", options=options(poses, "auto"))


def test_one_file_of_poses_goes_with_one_log(tmp_path: Path, run: Run) -> None:
    log, poses = table(tmp_path / "a.csv", run), tum(tmp_path / "p.txt", run)
    with pytest.raises(SettingsError, match=r"one file of poses goes with one log .*--poses"):
        open_log(log, log, options=options(poses))
