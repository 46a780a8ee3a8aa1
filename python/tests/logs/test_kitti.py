# SPDX-License-Identifier: Apache-2.0
"""Poses of the KITTI format get the times beside them and a frame that drives along x."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.kitti import read_kitti
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Floats
from slipwise.logs.pose_file import read_pose_file

CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # camera axes in those of the robot


def circle(count: int = 40) -> tuple[Floats, Floats, Floats]:
    """Rotations, places and yaws of a robot on a circle of 5 m to the left."""
    yaw = np.linspace(0.0, 1.5, count)
    turn = np.zeros((count, 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(yaw)
    turn[:, 1, 0], turn[:, 0, 1], turn[:, 2, 2] = np.sin(yaw), -np.sin(yaw), 1.0
    return turn, np.stack([5 * np.sin(yaw), 5 * (1 - np.cos(yaw)), 0 * yaw], axis=1), yaw


def lines(turn: Floats, place: Floats) -> str:
    rows = np.concatenate([turn, place[:, :, None]], axis=2).reshape(-1, 12)
    return "\n".join(" ".join(f"{number:.9e}" for number in row) for row in rows) + "\n"


def write(folder: Path, content: str, times: str, name: str = "times.txt") -> Path:
    (folder / name).write_text(times)
    (folder / "00.txt").write_text(content)
    return folder / "00.txt"


def stamps(count: int = 40) -> str:
    return "".join(f"{0.1 * k:.6e}\n" for k in range(count))


@pytest.mark.parametrize("name", ["times.txt", "00_times.txt"])
def test_poses_of_a_robot_are_taken_as_they_are(tmp_path: Path, name: str) -> None:
    turn, place, yaw = circle()
    found = read_pose_file(write(tmp_path, lines(turn, place), stamps(), name), {}, Tally())
    assert (found.format, found.has_heading) == ("kitti", True)
    np.testing.assert_allclose(found.stream.t, 0.1 * np.arange(40))
    np.testing.assert_allclose(found.stream.columns["x"], place[:, 0], atol=1e-8)
    np.testing.assert_allclose(found.stream.columns["yaw"], yaw, atol=1e-8)
    assert found.notes[0] == f"times of 00.txt are those of {name}"
    assert "guess: the poses do not drive along their z axis" in found.notes[1]


def test_poses_of_a_camera_are_turned_to_those_of_the_robot(tmp_path: Path) -> None:
    turn, place, yaw = circle()
    content = lines(CAMERA.T @ turn @ CAMERA, place @ CAMERA)
    found = read_pose_file(write(tmp_path, content, stamps()), {}, Tally())
    np.testing.assert_allclose(found.stream.columns["y"], place[:, 1], atol=1e-8)
    np.testing.assert_allclose(found.stream.columns["yaw"], yaw, atol=1e-8)
    np.testing.assert_allclose(found.stream.columns["roll"], 0.0, atol=1e-8)
    assert "guess: the poses drive along their z axis" in found.notes[1]


def test_what_does_not_belong_together_is_refused(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for content, times, message in [
        (lines(*circle()[:2]), stamps(39), r"39 times for 40 poses .*times\.txt"),
        (lines(*circle()[:2])[:-30], stamps(), r"not 12 numbers \(00\.txt, line 40\)"),
        (lines(*circle()[:2]), stamps(39) + "soon\n", r"not 1 number \(times\.txt, line 40\)"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n" + 12 * "1e200 " + "\n", "0\n1\n", r"not a rotation \(00\.txt, pose 2\)"),
        ("1 0 0 0 0 1 0 0 0 0 -1 0\n", "0\n", "not a rotation"),
        ("1 0 0 0 0 1 0 0 0 0 1 1e999\n", "0\n", "not 12 numbers"),
    ]:
        with (
            subtests.test(content=content, times=times, message=message),
            pytest.raises(LogError, match=message),
        ):
            read_pose_file(write(tmp_path, content, times), {}, Tally())


def test_huge_places_are_kept_for_the_cleaning_that_counts_them(tmp_path: Path) -> None:
    content = "1 0 0 0 0 1 0 0 0 0 1 0\n" + "1 0 0 1e308 0 1 0 -1e308 0 0 1 0\n"
    path = write(tmp_path, content, "0\n1\n")
    stream, notes = read_kitti(path, content)
    assert stream.columns["x"].tolist() == [0.0, 1e308]
    assert "do not drive along their z axis" in notes[1]
