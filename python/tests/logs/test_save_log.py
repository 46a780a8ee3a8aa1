# SPDX-License-Identifier: Apache-2.0
"""Tests that logs are written whole and read back equal."""

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError, OutputError
from slipwise.logs import Inputs, Log, Poses, Run, Source, empty_poses, open_log, save_log

ENDINGS = (".csv", ".csv.gz", ".parquet", ".mcap")


def assert_same(a: Inputs | Poses | None, b: Inputs | Poses | None, *, tolerance: float = 0.0) -> None:
    assert type(a) is type(b)
    if a is None or b is None:
        return
    for column in fields(a):
        first, second = getattr(a, column.name), getattr(b, column.name)
        assert (first is None) == (second is None), column.name
        if first is not None:
            np.testing.assert_allclose(second, first, rtol=0, atol=tolerance, err_msg=column.name)


def assert_equal(a: Log, b: Log, *, tolerance: float = 0.0) -> None:
    assert [run.name for run in a.runs] == [run.name for run in b.runs]
    for first, second in zip(a.runs, b.runs, strict=True):
        assert_same(first.commands, second.commands, tolerance=tolerance)
        assert_same(first.wheels, second.wheels, tolerance=tolerance)
        assert_same(first.poses, second.poses, tolerance=tolerance)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_log_reads_back_equal(log: Log, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"drive{ending}"
    save_log(log, path)
    back = open_log(path)
    assert_equal(log, back, tolerance=1e-12 if ending == ".mcap" else 0.0)
    assert back.left_out == ()
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("ending", ENDINGS)
def test_runs_stay_apart(drive: Callable[..., Run], tmp_path: Path, ending: str) -> None:
    log = Log(runs=(drive("one", start=0.0), drive("two", start=500.0, seed=2)))
    path = tmp_path / f"drive{ending}"
    save_log(log, path)
    assert_equal(log, open_log(path), tolerance=1e-9)


def test_runs_at_the_same_time_are_laid_one_after_the_other_in_a_bag(
    drive: Callable[..., Run], tmp_path: Path
) -> None:
    log = Log(runs=(drive("one"), drive("two", seed=2)))
    save_log(log, tmp_path / "drive.mcap")
    one, two = open_log(tmp_path / "drive.mcap").runs
    assert two.poses.t[0] - one.poses.t[-1] > 10.0
    np.testing.assert_allclose(two.poses.t - two.poses.t[0], log.runs[1].poses.t, atol=1e-9)


def test_positions_without_headings_are_not_written_as_poses(run: Run, tmp_path: Path) -> None:
    log = Log(runs=(replace(run, poses=replace(run.poses, course=True)),))
    with pytest.raises(LogError, match=r"positions without headings.*\.csv or \.parquet"):
        save_log(log, tmp_path / "a.mcap")
    save_log(log, tmp_path / "a.csv")
    assert open_log(tmp_path / "a.csv").runs[0].poses.course


@pytest.mark.parametrize("ending", ENDINGS)
def test_frames_and_attitude_survive(run: Run, tmp_path: Path, ending: str) -> None:
    count = len(run.poses)
    poses = replace(
        run.poses,
        frame=(np.arange(count) >= count // 2).astype(np.int64),
        z=np.linspace(0.0, 1.0, count),
        roll=np.full(count, 0.1),
        pitch=np.linspace(-0.3, 0.3, count),
    )
    log = Log(runs=(replace(run, poses=poses, wheels=None),))
    save_log(log, tmp_path / f"drive{ending}")
    assert_equal(log, open_log(tmp_path / f"drive{ending}"), tolerance=1e-9)


@pytest.mark.parametrize("ending", ENDINGS[:3])
def test_other_columns_survive_in_tables(run: Run, tmp_path: Path, ending: str) -> None:
    terrain = np.array(["sand", "gravel"], dtype=object)[np.arange(len(run.poses)) % 2]
    extra = {"t": run.poses.t, "terrain": terrain, "gyro_z": np.linspace(0.0, 1.0, len(run.poses))}
    save_log(Log(runs=(replace(run, extra=extra),)), tmp_path / f"drive{ending}")
    back = open_log(tmp_path / f"drive{ending}").runs[0].extra
    there = ~np.isnan(back["gyro_z"])
    np.testing.assert_array_equal(back["t"][there], extra["t"])
    np.testing.assert_array_equal(back["gyro_z"][there], extra["gyro_z"])
    assert back["terrain"][there].tolist() == terrain.tolist()


def test_the_same_log_gives_the_same_table(log: Log, tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        save_log(log, tmp_path / name)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_an_unknown_ending_is_refused(log: Log, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"\.csv\.gz, \.parquet or \.mcap"):
        save_log(log, tmp_path / "drive.xlsx")


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_log_without_samples_is_refused_and_leaves_no_file(tmp_path: Path, ending: str) -> None:
    log = Log(runs=(Run(name="r", commands=None, wheels=None, poses=empty_poses()),))
    with pytest.raises(LogError):
        save_log(log, tmp_path / f"drive{ending}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_log_whose_poses_were_all_left_out_is_refused(run: Run, tmp_path: Path, ending: str) -> None:
    log = Log(runs=(replace(run, poses=empty_poses()),), sources=(Source("bad.mcap", "00", "mcap", 60),))
    with pytest.raises(
        LogError, match=r"the log has no poses to write \(bad\.mcap\): `slipwise inspect` says"
    ):
        save_log(log, tmp_path / f"drive{ending}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("ending", ENDINGS)
def test_ctrl_c_leaves_the_old_file_and_no_half_one(
    log: Log, tmp_path: Path, ending: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"drive{ending}"
    path.write_bytes(b"old")

    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        save_log(log, path)
    assert path.read_bytes() == b"old"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_real_logs_read_back_equal(real_log_dir: Path, tmp_path: Path, subtests: pytest.Subtests) -> None:
    for name in ["warthog/grass.csv.gz", "drive_test/husky.csv.gz", "f1tenth/DS5.csv.gz"]:
        for ending in [".csv", ".parquet"]:
            with subtests.test(name=name, ending=ending):
                log = open_log(real_log_dir / name)
                save_log(log, tmp_path / f"copy{ending}")
                assert_equal(log, open_log(tmp_path / f"copy{ending}"))


def test_stamps_that_a_bag_cannot_hold_are_refused(run: Run, tmp_path: Path) -> None:
    assert run.commands is not None
    late = replace(
        run,
        commands=replace(run.commands, t=run.commands.t + 3e9),
        wheels=None,
        poses=replace(run.poses, t=run.poses.t + 3e9),
    )
    with pytest.raises(LogError, match=r"stamps in a bag end at 2147483647 s .*write a table"):
        save_log(Log(runs=(late,)), tmp_path / "late.mcap")
    assert list(tmp_path.iterdir()) == []
