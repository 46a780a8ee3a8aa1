# SPDX-License-Identifier: Apache-2.0
"""DART, a small car, on two floors in turn, and a Robotino on floors and with loads.

DART's encoder speed and gyroscope are its wheel twist, Vicon its poses; a run is a visit. Robotino's sets
are visited from commands, once around with every second run and again with the others. No label says what
the floor is. Which floor a name means is told by the first visit that ended on it; a visit is right from
the first window after which that floor's names stay the likeliest.
"""

from __future__ import annotations

import argparse
import csv
import gzip
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from data_sets import data_folder
from numpy.typing import NDArray

import slipwise
from slipwise.calibration.learned_sequence import LearnedSequence, learn_sequence
from slipwise.calibration.prepared_run import PreparedRun, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Inputs, Log, Poses, Run

Floats = NDArray[np.float64]

DART = {"rubbery": "dart_rubbery_floor.csv.gz", "tiles": "dart_tape_and_tiles.csv.gz"}
ROBOTINO = ("gray_surface", "brown_surface", "table_surface", "load_gray_surface")
HORIZON = 1.0  # s
TURNING = 0.2  # rad/s
LONG = 1e7  # s, longer than any run


@dataclass(frozen=True)
class Visit:
    """One visit of a sequence."""

    floor: str
    name: str  # of the surface that it ended on
    turning: int | None  # windows that turn until it is on the right surface for good; None: never
    switches: int  # surfaces taken after the first one of the visit, on one floor
    minutes: float


def dart_runs(path: Path) -> list[Log]:
    """Read the runs of one of DART's files, each as a log of its own."""
    rows: dict[str, list[list[float]]] = {}
    with gzip.open(path, "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            columns = ("t", "odo_v", "gyro_z", "x", "y", "yaw", "pose_new")
            rows.setdefault(row["run"], []).append([float(row[name]) for name in columns])
    return [dart_log(name, np.array(values)) for name, values in rows.items()]


def dart_log(name: str, values: Floats) -> Log:
    """Return a log of one run from t, speed, yaw rate, x, y, yaw and whether the pose is new, [N, 7]."""
    values = values[np.concatenate(([True], np.diff(values[:, 0]) > 0.0))]
    t, v, omega = values[:, :3].T.copy()
    new = values[values[:, 6] > 0.0]
    wheels = Inputs(t=t, v=v, vy=np.zeros(len(t)), omega=omega)
    place, x, y, yaw = new[:, [0, 3, 4, 5]].T.copy()
    poses = Poses(t=place, x=x, y=y, yaw=yaw, frame=np.zeros(len(new), np.int64))
    return Log((Run(name=name, commands=None, wheels=wheels, poses=poses),))


def in_turn(drives: dict[str, list[tuple[PreparedRun, ...]]]) -> list[tuple[str, tuple[PreparedRun, ...]]]:
    """Return the visits of floors one after the other, as often as the floor with the fewest runs allows."""
    count = min(len(each) for each in drives.values())
    return [(floor, each[i]) for i in range(count) for floor, each in drives.items()]


def meant_by(floors: Sequence[str], names: Sequence[str]) -> dict[str, str]:
    """Return the floor that each name means: of the first visit that ended on it."""
    meant: dict[str, str] = {}
    for floor, name in zip(floors, names, strict=True):
        meant.setdefault(name, floor)
    return meant


def place(run: NDArray[np.int64], t: Floats) -> Floats:
    """Return numbers that order windows by their run, then by time."""
    return np.asarray(LONG * run + t)


def visits_of(drives: Sequence[tuple[str, tuple[PreparedRun, ...]]], learned: LearnedSequence) -> list[Visit]:
    """Return what became of each visit."""
    meant = meant_by([floor for floor, _ in drives], [log.surface for log in learned.logs])
    visits = []
    for (floor, _), log in zip(drives, learned.logs, strict=True):
        made, course = log.predictions[0], log.course
        turning: int | None = None
        minutes = 0.0
        if course is not None and len(course.t):
            likeliest = [course.names[i] for i in course.probability.argmax(axis=1)]
            wrong = [i for i, name in enumerate(likeliest) if meant.get(name, floor) != floor]
            places = place(course.run, course.t)
            last = places[wrong[-1]] if wrong else -np.inf
            minutes = (
                sum(float(np.ptp(course.t[course.run == run])) for run in set(course.run.tolist())) / 60.0
            )
            rate = np.abs(made.measured[:, 2]) / HORIZON
            turning = int(((rate > TURNING) & (place(made.run - made.run.min(), made.t_end) <= last)).sum())
            never = meant[log.surface] != floor or (wrong and wrong[-1] == len(likeliest) - 1)
            turning = None if never else turning
        taken = sum(change.what in ("new", "recalled") for change in log.changes)
        visits.append(Visit(floor, log.surface, turning, max(taken - 1, 0), minutes))
    return visits


def print_visits(title: str, visits: Sequence[Visit]) -> None:
    """Print each visit, and all of them together."""
    print(f"\n{title}\n\n| floor | surface | turning windows until right | false switches | minutes |")
    print("|---|---|---|---|---|")
    for each in visits:
        soon = "never" if each.turning is None else each.turning
        print(f"| {each.floor} | {each.name or 'open'} | {soon} | {each.switches} | {each.minutes:.1f} |")
    print(
        f"false switches: {sum(v.switches for v in visits)} in {sum(v.minutes for v in visits):.0f} minutes"
    )


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dart", type=Path, help="folder with DART's files")
    parser.add_argument("--robotino", action="store_true", help="Robotino's sets of SLIPWISE_DATA")
    arguments = parser.parse_args()
    if arguments.dart is not None:
        runs = {
            floor: [prepare_run(log, "wheel") for log in dart_runs(arguments.dart / name)]
            for floor, name in DART.items()
        }
        drives = in_turn(runs)
        learned = learn_sequence([drive for _, drive in drives], Settings(), (HORIZON,))
        print_visits("DART, encoder and gyroscope as wheel twist", visits_of(drives, learned))
    folder = data_folder()
    if arguments.robotino and folder is not None:
        logs = {name: slipwise.open_log(folder / "robotino" / f"{name}.csv.gz") for name in ROBOTINO}
        prepared = {name: prepare_run(log, "command") for name, log in logs.items()}
        drives = [(name, runs[half::2]) for half in range(2) for name, runs in prepared.items()]
        learned = learn_sequence([drive for _, drive in drives], Settings(), (HORIZON,))
        print_visits("Robotino, from commands", visits_of(drives, learned))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
