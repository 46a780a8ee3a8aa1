# SPDX-License-Identifier: Apache-2.0
"""A program beside `evaluate`: it reads a tidy CSV row by row and pushes what it finds into a learner."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from slipwise import _core

Numbers = tuple[float, ...]
Item = tuple[str, Numbers]  # the stream, and what its push takes


@dataclass
class CsvRun:
    """The measurements of one run, in the order of the file."""

    name: str
    items: list[Item] = field(default_factory=list)


def read_runs(path: Path) -> Iterator[CsvRun]:
    """Yield the runs of a file whose runs follow each other."""
    run, frames, before = CsvRun(""), dict[str, int](), Numbers()
    with gzip.open(path, "rt", encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row.get("run", "") != run.name:
                if run.items:
                    yield run
                run, frames, before = CsvRun(row["run"]), {}, ()
            pose = _pose(row, frames)
            fresh = bool(pose) and (row["pose_new"] == "1" if "pose_new" in row else pose[1:] != before)
            before = pose[1:]
            run.items += _inputs(row)
            if fresh:
                run.items += [*_attitude(row), ("pose", pose)]
    yield run


def _inputs(row: Mapping[str, str]) -> list[Item]:
    names = {"command": ("cmd_v", "cmd_omega"), "wheels": ("odo_v", "odo_omega")}
    found = {stream: _numbers(row, "t", *columns) for stream, columns in names.items()}
    return [(stream, (*numbers, 0.0)) for stream, numbers in found.items() if numbers]


def _attitude(row: Mapping[str, str]) -> list[Item]:
    numbers = _numbers(row, "t", "roll", "pitch")
    return [("attitude", numbers)] if numbers else []


def _pose(row: Mapping[str, str], frames: dict[str, int]) -> Numbers:
    numbers = _numbers(row, "t", "x", "y", "yaw")
    if not numbers:
        return ()
    return (*numbers, frames.setdefault(row.get("frame", ""), len(frames)))


def _numbers(row: Mapping[str, str], *names: str) -> Numbers:
    """The numbers of some columns; nothing where one is missing."""
    texts = [row.get(name) or "nan" for name in names]
    numbers = tuple(float(text) for text in texts)
    return numbers if np.isfinite(numbers).all() else ()


def push(learner: _core.MotionLearner, item: Item) -> None:
    """Push one measurement."""
    stream, numbers = item
    if stream == "pose":
        learner.push_pose(*numbers[:4], int(numbers[4]))
    elif stream == "attitude":
        learner.push_attitude(*numbers)
    elif stream == "wheels":
        learner.push_wheels(*numbers)
    else:
        learner.push_command(*numbers)


def inputs_ahead(run: CsvRun, place: int, stream: str, end: float) -> np.ndarray:
    """Return the inputs behind item `place` and until `end` [s]; rows of (t, v, vy, omega), [N, 4]."""
    rows = list[Numbers]()
    for name, numbers in run.items[place + 1 :]:
        if numbers[0] > end:
            break
        if name == stream and (not rows or numbers[0] > rows[-1][0]):
            t, v, omega, vy = numbers
            rows.append((t, v, vy, omega))
    return np.array(rows).reshape(-1, 4)


def seconds_between(start: float, end: float) -> float:
    """Return what added to `start` gives `end` to the last bit."""
    seconds = end - start
    while start + seconds < end:
        seconds = float(np.nextafter(seconds, np.inf))
    while start + seconds > end:
        seconds = float(np.nextafter(seconds, -np.inf))
    assert start + seconds == end
    return seconds
