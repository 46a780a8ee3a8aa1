# SPDX-License-Identifier: Apache-2.0
"""Reads poses of the KITTI format, 12 numbers a line, with the times that stand in a file beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.log import ABSURD, OPTIONAL_POSE_COLUMNS, Floats
from slipwise.logs.piped import LARGEST
from slipwise.logs.streams import RawStream

TIMES = "times.txt"
_TO_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # x forward of z, y left of -x
_ORTHOGONAL = 1e-2  # how far R^T R may be from the identity


def read_kitti(path: Path, text: str) -> tuple[RawStream, tuple[str, ...]]:
    """Return the poses and what was guessed: a robot drives along its x axis, a camera along its z axis.

    A line is the upper three rows of the matrix that maps the robot, or the camera, into the world. (Geiger,
    Lenz and Urtasun, 2012)

    Raises:
        LogError: there are no times, or not as many as poses, or a line is no pose.
    """
    poses = _numbers(path, text, 12).reshape(-1, 3, 4)
    times_file = _times_file(path)
    times = _numbers(times_file, times_file.read_text(encoding="utf-8-sig", errors="replace"), 1)[:, 0]
    if len(times) != len(poses):
        said = f"{len(times)} times for {len(poses)} poses"
        raise LogError(said, where=str(times_file), advice="give the times of these poses")
    turn, place = poses[:, :, :3], poses[:, :, 3]
    with np.errstate(over="ignore", invalid="ignore"):  # numbers that overflow are no rotation either
        gap = np.abs(turn.transpose(0, 2, 1) @ turn - np.eye(3)).max(axis=(1, 2))
        good = (gap < _ORTHOGONAL) & (np.linalg.det(turn) > 0.0)
    if not good.all():
        where = f"{path.name}, pose {int(np.argmin(good)) + 1}"
        raise LogError("a pose is not a rotation", where=where, advice="write the poses again")
    turn, place, note = _robot_frame(turn, place)
    columns = {
        **dict(zip(("x", "y", "z"), place.T, strict=True)),
        "yaw": np.arctan2(turn[:, 1, 0], turn[:, 0, 0]),
        "pitch": np.arcsin(np.clip(-turn[:, 2, 0], -1.0, 1.0)),
        "roll": np.arctan2(turn[:, 2, 1], turn[:, 2, 2]),
    }

    def where_is(number: int) -> str:
        return f"{path.name}, pose {number}"

    numbers = np.arange(1, len(poses) + 1)
    stream = RawStream("poses", times, columns, numbers, where_is, frozenset(OPTIONAL_POSE_COLUMNS))
    return stream, (f"times of {path.name} are those of {times_file.name}", note)


def _times_file(path: Path) -> Path:
    """Return the file of times beside the poses.

    Raises:
        LogError: there is none, or it is too large.
    """
    for beside in (path.with_name(f"{path.stem}_{TIMES}"), path.with_name(TIMES)):
        if beside.is_file():
            if beside.stat().st_size > LARGEST:
                raise LogError(
                    f"more than {LARGEST >> 30} GiB of times", where=str(beside), advice="thin them"
                )
            return beside
    advice = f"put {TIMES} or {path.stem}_{TIMES} beside it, one time a line, or give TUM (..._tum.txt)"
    raise LogError("poses of the KITTI format have no times", where=str(path), advice=advice)


def _robot_frame(turn: Floats, place: Floats) -> tuple[Floats, Floats, str]:
    """Return the poses with x forward and z up, and which axis the poses drive along."""
    possible = np.abs(np.diff(place, axis=0)).max(axis=1) < ABSURD if len(place) else np.zeros(0, bool)
    steps = np.einsum("nji,nj->ni", turn[:-1][possible], np.diff(place, axis=0)[possible])
    if possible.any() and int(np.argmax(np.abs(steps).sum(axis=0))) == 2:  # z
        note = "guess: the poses drive along their z axis, and are turned as a camera's: x forward, z up"
        return _TO_CAMERA @ turn @ _TO_CAMERA.T, place @ _TO_CAMERA.T, note
    return turn, place, "guess: the poses do not drive along their z axis, so their x is forward and z up"


def _numbers(path: Path, text: str, width: int) -> Floats:
    """Return the rows of numbers [N, width].

    Raises:
        LogError: a line is something else.
    """
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.startswith("#"):
            continue
        try:
            row = [float(part) for part in line.replace(",", " ").split()]
        except ValueError:
            row = []
        if len(row) != width or not np.isfinite(row).all():
            said, where = f"not {width} number{'s' if width > 1 else ''}", f"{path.name}, line {number}"
            raise LogError(
                said, where=where, advice="write the file again, or take the line and its fellow out"
            )
        rows.append(row)
    return np.array(rows, dtype=np.float64).reshape(-1, width)
