# SPDX-License-Identifier: Apache-2.0
"""The same drive at another hour, in another frame, or with its streams arriving in another order."""

from __future__ import annotations

import csv
import gzip
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slipwise import _core
from slipwise.calibration import Calibration
from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.segments import recording_rows

MOST = 0.01  # standard deviations that a parameter may move


@dataclass(frozen=True)
class Move:
    """What is added to stamps [s] and to the frame of the poses: x, y [m], then a turn [rad]."""

    seconds: float = 0.0
    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0


MOVES = {
    "100 s later": Move(seconds=100.0),
    "today": Move(seconds=1.7e9),
    "in UTM, turned": Move(x=5e5, y=5.3e6, turn=2.0),
}


def moved_log(log: Log, move: Move) -> Log:
    """Return a log in memory moved."""

    def inputs(given: Inputs | None) -> Inputs | None:
        return None if given is None else replace(given, t=given.t + move.seconds)

    def poses(given: Poses) -> Poses:
        c, s = np.cos(move.turn), np.sin(move.turn)
        x, y = c * given.x - s * given.y + move.x, s * given.x + c * given.y + move.y
        return replace(given, t=given.t + move.seconds, x=x, y=y, yaw=given.yaw + move.turn)

    def run(given: Run) -> Run:
        return replace(
            given, commands=inputs(given.commands), wheels=inputs(given.wheels), poses=poses(given.poses)
        )

    return replace(log, runs=tuple(run(each) for each in log.runs))


def moved_table(path: Path, to: Path, move: Move, left_out: Collection[str] = ()) -> Path:
    """Write a table of measurements moved, `to` a file, without some columns; others stay as they are."""
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", newline="") as file:
        rows = list(csv.DictReader(file))
    c, s = math.cos(move.turn), math.sin(move.turn)
    for row in rows:
        if row["t"]:
            row["t"] = repr(float(row["t"]) + move.seconds)
        if row.get("x") and row.get("y"):
            x, y = float(row["x"]), float(row["y"])
            row["x"], row["y"] = repr(c * x - s * y + move.x), repr(s * x + c * y + move.y)
        if row.get("yaw"):
            row["yaw"] = repr(float(row["yaw"]) + move.turn)
    with to.open("w", newline="") as file:
        columns = [name for name in rows[0] if name not in left_out]
        writer = csv.DictWriter(file, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    return to


def differences(one: Calibration, other: Calibration) -> Iterator[str]:
    """Say which parameters moved by more than may be, and whether the verdict is another."""
    before, after = one.model.parameters, other.model.parameters
    if set(before) != set(after):
        yield f"other parameters: {set(before) ^ set(after)}"
        return
    for name, parameter in before.items():
        moved = abs(after[name].value - parameter.value)
        if moved > MOST * parameter.std:
            yield f"{name} moved by {moved / parameter.std:.2g} sigma"
    if (one.verdict.good, one.verdict.not_identifiable) != (
        other.verdict.good,
        other.verdict.not_identifiable,
    ):
        yield f"the verdict was '{one.verdict.sentence}' and is '{other.verdict.sentence}'"


#: By how much later than stamped each stream arrives [s].
ARRIVALS: Mapping[str, Mapping[str, float]] = {
    "poses late": {"poses": 0.4, "attitudes": 0.3},
    "inputs late": {"commands": 0.4, "wheels": 0.25},
    "wheels late": {"wheels": 0.45, "poses": 0.1},
}


def push_arriving(learner: _core.MotionLearner, run: Run, late: Mapping[str, float]) -> None:
    """Push a run in the order in which its streams arrive."""
    commands, wheels, attitudes, poses = recording_rows(run)
    push: Mapping[str, tuple[np.ndarray, Callable[[list[float]], None]]] = {
        "commands": (commands, lambda r: learner.push_command(r[0], r[1], r[3], r[2])),
        "wheels": (wheels, lambda r: learner.push_wheels(r[0], r[1], r[3], r[2])),
        "attitudes": (attitudes, lambda r: learner.push_attitude(*r)),
        "poses": (poses, lambda r: learner.push_pose(r[0], r[1], r[2], r[3], int(r[4]), r[5], r[6])),
    }
    arriving = [
        (row[0] + late.get(name, 0.0), place, name, row)
        for place, (name, (rows, _)) in enumerate(push.items())
        for row in rows.tolist()
    ]
    for _, _, name, row in sorted(arriving, key=lambda each: each[:2]):
        push[name][1](row)
