# SPDX-License-Identifier: Apache-2.0
"""Tests on real logs: the sound ones pass, the one with bad poses is caught."""

from pathlib import Path

import numpy as np
import pytest

from slipwise.logs import open_log

SOUND = ("warthog", "create", "race_car", "robotino", "f1tenth", "tricycle", "drive_test")


def test_sound_logs_lose_no_pose(real_log_dir: Path, subtests: pytest.Subtests) -> None:
    for folder in SOUND:
        with subtests.test(folder=folder):
            paths = sorted((real_log_dir / folder).glob("*.csv.gz"))
            assert paths
            for path in paths:
                log = open_log(path)
                assert [entry for entry in log.left_out if entry.kind.startswith("pose-")] == [], path.name
                assert sum(len(run.poses) for run in log.runs) > 500


def test_duplicate_stamps_of_the_husky_on_tile_are_counted(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "husky/tile_deflated_tyres.csv.gz")
    assert [(entry.kind, entry.count) for entry in log.left_out] == [("duplicate-stamp", 45)] * 2


def test_the_jumping_poses_of_the_husky_on_wet_grass_are_caught(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "husky/wetgrass_bad_poses.csv.gz")
    found = {entry.kind: entry.count for entry in log.left_out}
    assert found["pose-jump"] >= 25
    poses = log.runs[0].poses
    same = np.diff(poses.frame) == 0
    step = np.hypot(np.diff(poses.x), np.diff(poses.y))
    assert step.max() > 10.0
    assert step[same].max() < 2.5


def test_the_robotino_moves_along_the_heading_of_its_speed(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "robotino/table_surface.csv.gz")
    for run in log.runs:
        assert run.commands is not None
        assert not run.commands.vy.any()
        course = np.arctan2(run.poses.y[-1] - run.poses.y[0], run.poses.x[-1] - run.poses.x[0])
        assert abs(course - np.median(run.poses.yaw)) < 0.35
